"""Two pages, a person at the file, one session: no edit is lost, and a field that two changed is chosen by a person."""

import random
import tomllib

import pytest

from mbkf.app.failures import Refused
from mbkf.app.notes import change_notes
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.session import plain_session, session_of, write_session
from mbkf.io.session_change import session_version
from tests.app.asking import asked, changed, plain
from tests.studies import study

ADDRESS = "/session?session=P1"
EDITS, INTERLEAVINGS = 6, 50
FIELDS = {
    ("name",): ("Ana", "Bo", None), ("mass_kg",): (60.0, 61.5, None), ("age",): (30.0, 31.0, None),
    ("sex",): ("female", "male"), ("trial", "walk1", "excluded"): ("fell", "stumbled", None),
    ("trial", "walk1", "kind"): ("walk", "run"), ("trial", "walk2", "excluded"): ("shoe", None),
}  # fmt: skip


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", trials=2)
    return Workspace(tmp_path / "lab")


def of(table, field):
    for key in field:
        table = table.get(key) if isinstance(table, dict) else None
    return table


def with_value(table, field, value):
    key, *deeper = field
    return {**table, key: with_value(table.get(key) or {}, deeper, value) if deeper else value}


class Tab:
    """A page as the browser holds it: the notes that it has seen, and their version."""

    def __init__(self, server, cookie):
        self.server, self.cookie = server, cookie
        self.load()

    def load(self):
        self.see(plain(self.server, self.cookie, ADDRESS)[1])

    def see(self, told):
        self.notes, self.version = told["notes"], told["version"]

    def save(self, notes):
        sent = {"base": self.notes, "notes": without_none(notes)}
        status, told = changed(self.server, self.cookie, ADDRESS, sent, self.version)
        assert status == (409 if told.get("differences") else 200)
        self.see(told)
        return told.get("differences", [])


@pytest.mark.parametrize("seed", range(INTERLEAVINGS))
def test_no_edit_of_two_pages_and_of_the_file_is_lost(server, cookie, seed):
    dice, file = random.Random(seed), server.workspace.root / "P1" / "session.toml"
    file.unlink(missing_ok=True)
    tabs = [Tab(server, cookie), Tab(server, cookie)]
    meant = {}
    for _ in range(EDITS):
        field = dice.choice(list(FIELDS))
        value = dice.choice(FIELDS[field])
        if dice.random() < 0.2:  # by hand, in the file
            now = plain_session(server.workspace.notes("P1"))
            write_session(session_of(without_none(with_value(now, field, value))), file)
            meant[field] = value
            continue
        tab = dice.choice(tabs)
        if dice.random() < 0.2:
            tab.load()
        seen = of(tab.notes, field)
        differences = tab.save(with_value(tab.notes, field, value))
        if not differences:
            assert value == seen or meant.get(field) in (seen, value), (
                "a change that the page had not seen is gone"
            )
            meant[field] = value if value != seen else meant.get(field)
            continue
        assert [tuple(one["field"]) for one in differences] == [field]
        (shown,) = differences
        assert (shown["mine"], shown["theirs"], shown["base"]) == (value, meant.get(field), seen)
        if dice.random() < 0.5:  # the person keeps the own value
            assert tab.save(with_value(tab.notes, field, value)) == []
            meant[field] = value
    found = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    assert {field: of(found, field) for field in FIELDS} == {field: meant.get(field) for field in FIELDS}


def without_none(table):
    """A table as a file holds it: without entries that are None."""
    pairs = {key: without_none(value) if isinstance(value, dict) else value for key, value in table.items()}
    return {key: value for key, value in pairs.items() if value is not None}


def test_a_reply_carries_its_version_and_a_change_needs_it(server, cookie):
    answer, _ = asked(server, ADDRESS, Cookie=cookie)
    version = answer.headers["ETag"]
    assert version == f'"{session_version(server.workspace.notes("P1"))}"'
    answer, text = asked(server, ADDRESS, "POST", '{"notes": {}}', Cookie=cookie)
    assert answer.status == 428 and b"load the page again" in text
    assert changed(server, cookie, ADDRESS, {"notes": {"age": 44}}, "0" * 32)[0] == 412
    assert (
        changed(server, cookie, ADDRESS, {"notes": {"age": 44}, "base": {"age": 3}}, version.strip('"'))[0]
        == 412
    )
    assert changed(server, cookie, ADDRESS, {"notes": {"age": 44}}, version.strip('"'))[0] == 200


def written(workspace, name, sent):
    return change_notes(workspace, name, {"notes": sent}, session_version(workspace.notes("P1")))


def test_notes_are_written(workspace):
    said = {"name": "A", "mass_kg": 60, "trial": {"walk1": {"kind": "run"}, "walk2": {"excluded": "fell"}}}
    assert written(workspace, "P1", said) == {}
    assert plain_session(workspace.survey("P1").notes) == {**said, "mass_kg": 60.0}


@pytest.mark.parametrize(
    "said", [{"name": 3}, {"mass_kg": -1}, {"trial": {"a": {"kind": "x"}}}, {"trial": "x"}]
)
def test_impossible_notes_are_refused_and_nothing_is_written(workspace, said):
    with pytest.raises(FileFormatError):
        written(workspace, "P1", said)
    assert not (workspace.root / "P1" / "session.toml").exists()
    with pytest.raises(InvalidInput, match="no session"):
        written(workspace, "P9", {})


@pytest.mark.parametrize("sent", [3, [1], "text", {}, {"notes": 3}])
def test_a_request_without_notes_is_refused(workspace, sent):
    with pytest.raises(InvalidInput, match="sent no notes"):
        change_notes(workspace, "P1", sent, "")


def test_another_version_is_refused(workspace):
    with pytest.raises(Refused) as refused:
        change_notes(workspace, "P1", {"notes": {}}, "other")
    assert refused.value.status == 412
