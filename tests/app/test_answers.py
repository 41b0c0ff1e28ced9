"""What the page is told and may state, as plain data."""

import json

import pytest

from mbkf.app import answers
from mbkf.app.runs import RunState
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from tests.studies import study


class States:
    """Runs that are as a test says."""

    def __init__(self, states):
        self.states = states

    def state(self, name):
        return self.states.get(name)


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", trials=2)
    return Workspace(tmp_path / "lab")


def test_a_session_is_told_whole(workspace):
    state = RunState("running", "trials", 1, 2, 4.0, trials={"walk1": ("failed", "why")})
    told = answers.session(workspace, States({"P1": state}), "P1")
    assert json.loads(json.dumps(told)) == told
    static, walk1, walk2 = told["trials"]
    assert (static["kind"], walk1["kind"], walk1["markers"], walk2["seconds"]) == ("static", "walk", 36, 2.51)
    assert (walk1["status"], walk1["reason"], walk2["status"]) == ("failed", "why", "")
    assert told["run"]["remaining_s"] == pytest.approx(4.0)
    assert told["notes"] == {} and told["standing_kg"] == pytest.approx(85.7, abs=0.5)
    assert answers.session(workspace, States({}), "P1")["run"] is None


def test_all_sessions_in_short(workspace):
    told = answers.sessions(workspace, States({"P1": RunState("finished")}))
    assert [one["id"] for one in told["sessions"]] == ["P1"]
    assert told["sessions"][0]["run"]["state"] == "finished" and told["folder"] == str(workspace.root)


def test_what_the_page_states_is_written(workspace):
    said = {"name": "A", "mass_kg": 60, "trial": {"walk1": {"kind": "run"}, "walk2": {"excluded": "fell"}}}
    answers.write_notes(workspace, "P1", said)
    told = answers.session(workspace, States({}), "P1")
    assert told["notes"] == {**said, "mass_kg": 60.0}
    assert [one["kind"] for one in told["trials"]] == ["static", "run", "walk"]
    assert told["trials"][2]["excluded"] == "fell"
    assert "85." in told["problems"][0]["what"]


@pytest.mark.parametrize("said", [3, [1], "text" * 3, {"mass_kg": -1}, {"trial": {"a": {"kind": "x"}}}])
def test_what_cannot_be_is_refused_and_nothing_written(workspace, said):
    if said == "texttexttext":
        said = {"name": 3}
    with pytest.raises(FileFormatError):
        answers.write_notes(workspace, "P1", said)
    assert not (workspace.root / "P1" / "session.toml").exists()
    with pytest.raises(InvalidInput, match="no session"):
        answers.write_notes(workspace, "P9", {})
