"""Sessions and trials deleted, renamed and moved: every byte is kept, names are checked, and all of it is undone."""

import re
from pathlib import Path

import pytest

import mbkf.app.arranging as arranging_module
from mbkf.app.arranging import Arranging
from mbkf.app.bin import BIN
from mbkf.app.failures import Refused
from mbkf.app.live_run import LiveRun
from mbkf.app.run_states import FINISHED, RunState
from mbkf.app.workspace import RESULTS, Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.session import TrialKind, read_session

STATED = '# by hand\r\nmass_kg = 70.0\n\n[trial.walk1]  # the best\nkind = "turn"\n'


class KnownRuns:
    """States of runs without a thread."""

    def __init__(self):
        self.states = {}
        self.busy = ""

    def is_busy(self, session):
        return session == self.busy

    def plain_state(self, session, trial=""):
        state = self.states.get(session)
        if state is None or (trial and trial not in state):
            return None
        return {"trials": {trial: state[trial]}} if trial else dict(state)

    def take(self, session, trial=""):
        if trial:
            self.states.get(session, {}).pop(trial, None)
        else:
            self.states.pop(session, None)

    def give(self, session, trial, plain):
        if trial:
            self.states.setdefault(session, {}).update(plain["trials"])
        else:
            self.states[session] = dict(plain)


@pytest.fixture
def runs():
    return KnownRuns()


@pytest.fixture
def lab(tmp_path):
    """A folder with two sessions and a result; its files hold their own names."""
    root = tmp_path / "lab"
    names = (
        "P1/static.c3d",
        "P1/walk1.c3d",
        "P1/walk1_grf.mot",
        "P1/notes.txt",
        "P2/walk1.c3d",
        "P2/monday/run.c3d",
    )
    for name in (*names, f"{RESULTS}/P1/walk1/summary.json"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(name)
    (root / "P1" / "session.toml").write_bytes(STATED.encode())
    return root


@pytest.fixture
def arranging(lab, runs):
    runs.states["P1"] = {"walk1": ["done", ""]}
    return Arranging(Workspace(lab), runs, LiveRun())


def files(root, hidden=False):
    """Every file and its bytes."""
    found = {
        path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()
    }
    return {name: content for name, content in found.items() if hidden or not name.startswith(".")}


ACTS = {
    "session deleted": lambda a: a.delete("P1"),
    "session renamed": lambda a: a.move("P1", "", "Q/tuesday", ""),
    "trial deleted": lambda a: a.delete("P1", "walk1"),
    "trial renamed": lambda a: a.move("P1", "walk1", "P1", "gang ä"),
    "trial moved": lambda a: a.move("P1", "walk1", "P3", "walk1"),
    "trial moved to the folder itself": lambda a: a.move("P1", "walk1", ".", "walk1"),
}


@pytest.mark.parametrize("act", sorted(ACTS))
def test_every_byte_is_kept_and_comes_back(act, arranging, lab, runs):
    before, states = files(lab), {name: dict(one) for name, one in runs.states.items()}
    made = ACTS[act](arranging)
    between = files(lab, hidden=True)
    assert files(lab) != before
    statements = {name for name in before if name.endswith("session.toml")}
    kept = [content for name, content in before.items() if name not in statements]
    assert all(content in between.values() for content in kept)
    (one,) = arranging.listed()
    assert one["key"] == made["key"]
    arranging.undo(made["key"])
    assert files(lab) == before and runs.states == states and arranging.listed() == []
    with pytest.raises(Refused, match="undone already"):
        arranging.undo(made["key"])


def test_a_session_keeps_results_and_state_under_its_new_name(arranging, lab, runs):
    assert arranging.move("P1", "", "Q/tuesday", "")["session"] == "Q/tuesday"
    assert (lab / "Q" / "tuesday" / "walk1.c3d").read_text() == "P1/walk1.c3d"
    assert (lab / RESULTS / "Q" / "tuesday" / "walk1" / "summary.json").is_file()
    assert runs.states == {"Q/tuesday": {"walk1": ["done", ""]}}


def test_a_trial_takes_forces_and_statements_with_it(arranging, lab, runs):
    arranging.move("P1", "walk1", "P3", "turn2")
    assert {path.name for path in (lab / "P3").iterdir()} == {"turn2.c3d", "turn2_grf.mot", "session.toml"}
    assert read_session(lab / "P3" / "session.toml").trial("turn2").kind == TrialKind.TURN
    own = read_session(lab / "P1" / "session.toml")
    assert own.trials == {} and own.mass_kg == 70.0
    assert "# by hand" in (lab / "P1" / "session.toml").read_text()
    assert not (lab / RESULTS / "P1" / "walk1").exists() and runs.states == {"P1": {}}


def test_statements_made_meanwhile_stay_when_a_trial_comes_back(arranging, lab):
    made = arranging.delete("P1", "walk1")
    file = lab / "P1" / "session.toml"
    file.write_text(file.read_text().replace("70.0", "71.5"))
    arranging.undo(made["key"])
    found = read_session(file)
    assert found.mass_kg == 71.5 and found.trial("walk1").kind == TrialKind.TURN


@pytest.mark.parametrize(
    ("session", "trial", "to", "name", "said"),
    [
        ("P1", "", "P2", "", "there already"),
        ("P1", "", "../out", "", "cannot be a file"),
        ("P1", "", RESULTS + "/x", "", "among the results"),
        ("P1", "", "P1/later", "", "in itself"),
        ("P1", "", " ", "", "cannot be a file"),
        ("P1", "", "a?b", "", "cannot be a file"),
        ("P1", "", "n" * 201, "", "too long"),
        ("P2", "", "P4", "", "holds other sessions"),
        (".", "", "P4", "", "no session"),
        ("P9", "", "P4", "", "no session 'P9'"),
        ("P1", "walk1", "P2", "WALK1", "already"),
        ("P1", "walk1", "P1", "static", "already"),
        ("P1", "walk1", "P1", "walk1", "as they were"),
        ("P1", "walk1", "P1", "a/b", "cannot be the name"),
        ("P1", "walk1", "P1", "", "cannot be the name"),
        ("P1", "walk1", "", "x", "cannot be a file"),
        ("P1", "walk1", "../out", "x", "cannot be a file"),
        ("P1", "walk1", "linked", "x", "leads out"),
        ("P1", "walk1", "P1", ".hidden", "cannot be a file"),
        ("P1", "walk9", "P1", "x", "no trial 'walk9'"),
    ],
)
def test_names_that_are_not_possible_change_nothing(session, trial, to, name, said, arranging, lab):
    (lab.parent / "outside").mkdir()
    (lab / "linked").symlink_to(lab.parent / "outside")
    before = files(lab)
    with pytest.raises((InvalidInput, Refused), match=re.escape(said)):
        arranging.move(session, trial, to, name)
    assert files(lab) == before and arranging.listed() == []


def test_results_of_a_former_session_are_not_mixed_with_others(arranging, lab):
    (lab / RESULTS / "Q").mkdir()
    before = files(lab)
    with pytest.raises(Refused, match="results/Q"):
        arranging.move("P1", "", "Q", "")
    assert files(lab) == before


def test_what_a_run_works_with_stays(arranging, lab, runs):
    key = arranging.delete("P1", "static")["key"]
    runs.busy = "P1"
    for act in (
        lambda: arranging.delete("P1"),
        lambda: arranging.move("P2", "walk1", "P1/", "w"),
        lambda: arranging.undo(key),
    ):
        with pytest.raises(Refused, match="being calculated"):
            act()
    assert (lab / "P1" / "walk1.c3d").is_file()


def test_a_second_page_that_deletes_again_gets_a_reason(arranging):
    arranging.delete("P1", "walk1")
    with pytest.raises(Refused, match="load the page again"):
        arranging.delete("P1", "walk1")
    arranging.delete("P1")
    with pytest.raises(InvalidInput, match="no session 'P1'"):
        arranging.delete("P1")


def test_nothing_that_came_meanwhile_is_replaced(arranging, lab):
    made = arranging.delete("P1", "walk1")
    (lab / "P1" / "walk1.c3d").write_text("a new one")
    with pytest.raises(Refused, match=re.escape("'P1/walk1.c3d' is there already")):
        arranging.undo(made["key"])
    assert (lab / "P1" / "walk1.c3d").read_text() == "a new one" and len(arranging.listed()) == 1


def test_a_bin_emptied_by_hand_is_stated(arranging, lab):
    made = arranging.delete("P1", "walk1")
    (lab / BIN / made["key"] / "P1").rename(lab.parent / "taken")
    (lab / BIN / made["key"] / RESULTS).rename(lab.parent / "taken results")
    with pytest.raises(Refused, match="no longer in"):
        arranging.undo(made["key"])


def test_a_move_that_fails_half_way_is_taken_back(arranging, lab, monkeypatch):
    before, rename, calls = files(lab), Path.rename, []

    def full(source, to):
        if source.suffix in {".c3d", ".mot"}:
            calls.append(source)
        if len(calls) == 2:
            calls.clear()
            raise OSError(28, "no space", str(to))
        return rename(source, to)

    monkeypatch.setattr(Path, "rename", full)
    with pytest.raises(OSError, match="no space"):
        arranging.delete("P1", "walk1")
    assert files(lab) == before and arranging.listed() == []


def test_statements_are_whole_after_a_change_that_fails_half_way(arranging, lab, monkeypatch):
    before, change = files(lab), arranging_module.change_session

    def full(path, *notes):
        if path.parent.name == "P1":
            raise OSError(28, "no space", str(path))
        return change(path, *notes)

    monkeypatch.setattr(arranging_module, "change_session", full)
    with pytest.raises(OSError, match="no space"):
        arranging.move("P1", "walk1", "P3", "turn2")
    assert files(lab) == before and arranging.listed() == []


def test_a_file_that_cannot_be_restored_leaves_the_trial_in_the_bin(arranging, lab):
    made, file = arranging.delete("P1", "walk1"), lab / "P1" / "session.toml"
    text = file.read_text()
    file.write_text("mass_kg = [")
    with pytest.raises(FileFormatError):
        arranging.undo(made["key"])
    assert not (lab / "P1" / "walk1.c3d").exists() and len(arranging.listed()) == 1
    file.write_text(text)
    arranging.undo(made["key"])
    assert (lab / "P1" / "walk1.c3d").is_file() and read_session(file).trial("walk1").kind == TrialKind.TURN


def test_results_made_under_the_new_name(arranging, lab, runs):
    """Those of a session come back with it; those of a trial never become another trial's."""
    trial = arranging.move("P1", "walk1", "P3/", "turn2")
    assert trial["session"] == "P3"
    (lab / RESULTS / "P3" / "turn2").mkdir(parents=True)
    runs.states["P3"] = {"turn2": ["done", ""]}
    arranging.undo(trial["key"])
    assert not (lab / RESULTS / "P3" / "turn2").exists() and runs.states["P3"] == {}
    whole = arranging.move("P1", "", "Q//x/", "")
    assert whole["session"] == "Q/x"
    runs.states["Q/x"] = {"walk1": ["failed", "why"]}
    arranging.undo(whole["key"])
    assert runs.states["P1"] == {"walk1": ["failed", "why"]} and "Q/x" not in runs.states


def test_a_session_that_moved_on_is_named(arranging):
    first = arranging.move("P1", "", "Q", "")
    second = arranging.move("Q", "", "R", "")
    with pytest.raises(Refused, match="undo the later change first"):
        arranging.undo(first["key"])
    arranging.undo(second["key"])
    assert arranging.undo(first["key"])["session"] == "P1"


def test_a_scaled_person_stays_with_the_session(arranging, lab):
    for name in ("subject.c3d", "subject.toml"):
        (lab / "P1" / name).write_text(name)
    arranging.delete("P1", "subject")
    assert (lab / "P1" / "subject.toml").is_file() and not (lab / "P1" / "subject.c3d").exists()


def test_a_recording_goes_into_the_bin_and_keeps_its_name(arranging, lab):
    place = lab / RESULTS / "P1" / "live-1"
    place.mkdir()
    for name in ("summary.json", "live.json"):
        (place / name).write_text("{}")
    with pytest.raises(InvalidInput, match="keeps its name"):
        arranging.move("P1", "live-1", "P1", "x")
    made = arranging.delete("P1", "live-1")
    assert not place.exists()
    arranging.undo(made["key"])
    assert (place / "live.json").is_file()


def test_states_of_runs_go_and_come(tmp_path):
    from mbkf.app.runs import Runs

    runs = Runs(Workspace(tmp_path / "lab"), workers=1)
    try:
        assert runs.plain_state("P1") is None and not runs.is_busy("P1")
        runs.give("P1", "", {"state": FINISHED, "trials": {"a": ["done", ""], "b": ["failed", "why"]}})
        known = runs.plain_state("P1", "b")
        assert known == {"trials": {"b": ("failed", "why")}} and runs.plain_state("P1", "c") is None
        runs.take("P1", "b")
        assert runs.state("P1") == RunState(FINISHED, trials={"a": ("done", "")})
        runs.give("P1", "b", known)
        assert runs.state("P1").trials["b"] == ("failed", "why")
        whole = runs.plain_state("P1")
        runs.take("P1")
        assert runs.state("P1") is None
        runs.give("P2", "", whole)
        assert runs.state("P2").trials["a"] == ("done", "")
    finally:
        runs.close()
