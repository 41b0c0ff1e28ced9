"""A session's marker set: changed on its standing trial, written beside its captures, stated and then used."""

import json
import re
from dataclasses import replace

import pytest

from mbkf.app.marker_sets import SET_FILE, MarkerSets, capture_to_show
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.model.protocol import load_protocol
from tests.studies import study, walk_folder


@pytest.fixture
def workspace(tmp_path):
    return Workspace(study(tmp_path / "lab", trials=1))


def key_of(page):
    """The name of an editor's page, from its address for requests."""
    return re.search(r'"say":"marker_set/say\?session=P1&page=([0-9a-f]+)"', page)[1]


def test_what_is_saved_is_the_sessions(workspace):
    sets = MarkerSets(workspace)
    page = sets.open("P1")
    key = key_of(page)
    assert "RASI" in page
    answer = json.loads(
        sets.say("P1", key, json.dumps({"do": "save", "choices": {"RASI": {"ignored": "loose"}}}))
    )
    assert answer["saved"] == SET_FILE and answer["ignored"] == 1
    assert workspace.survey("P1").notes.protocol == SET_FILE
    (person,) = workspace.plan("P1").persons
    assert dict(load_protocol(person.protocol).ignored) == {"RASI": "loose"}
    again = sets.open("P1")
    key = key_of(again)
    assert "loose" in again, "the page begins with the set that is stated"
    assert json.loads(sets.say("P1", key, '{"do": "done"}')) == {"done": True}


def test_an_unknown_set_is_told_until_one_is_stated(workspace):
    folder = workspace.root / "P1"
    for path in folder.glob("*.c3d"):
        capture = read_capture(path)
        odd = replace(capture.markers, names=tuple(f"Q{k}" for k in range(len(capture.markers.names))))
        path.unlink()
        write_c3d(replace(capture, markers=odd), path)

    def doubts():
        return [one for trial in workspace.survey("P1").trials for one in trial.problems if one.marker_set]

    assert len(doubts()) == 2
    sets = MarkerSets(workspace)
    key = key_of(sets.open("P1"))
    sets.say("P1", key, '{"do": "save", "choices": {}}')
    assert doubts() == []


def test_the_standing_trial_is_shown(workspace):
    assert capture_to_show(workspace.survey("P1")).name == "static.c3d"
    (workspace.root / "P1" / "static.c3d").unlink()
    assert capture_to_show(workspace.survey("P1")).name == "walk1.c3d"
    (workspace.root / "P1" / "walk1.c3d").unlink()
    write_c3d(read_capture(walk_folder() / "raw.c3d"), workspace.root / "P1" / "walk1.c3d")
    with pytest.raises(InvalidInput, match="named markers"):
        capture_to_show(workspace.survey("P1"))


def test_nothing_is_said_before_a_page_is_open(workspace):
    with pytest.raises(InvalidInput, match="is not open; open it again"):
        MarkerSets(workspace).say("P1", "", '{"do": "done"}')
