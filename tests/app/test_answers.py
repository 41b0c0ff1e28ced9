"""What the page is told and may state, as plain data."""

import json

import pytest

from mbkf.app import answers
from mbkf.app.runs import RunState
from mbkf.app.workspace import Workspace
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
