"""What the page is told and may state, as plain data."""

import json
import shutil

import pytest

from mbkf.app import answers
from mbkf.app.run_states import RunState
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import SessionNotes
from mbkf.io.verdict import Verdict
from mbkf.study.batch.person import RECORD
from mbkf.study.batch.progress import Progress
from mbkf.trial.results.summary import summarise
from tests.io.reconstructions import made_up
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
    under_way = {"walk2": Progress("Filtering", 250, 500)}
    trials = {"walk1": ("failed", "why")}
    state = RunState("running", "trials", 1, 2, 4.0, trials=trials, under_way=under_way)
    told = answers.session(workspace, States({"P1": state}), "P1")
    assert json.loads(json.dumps(told)) == told
    static, walk1, walk2 = told["trials"]
    assert (static["kind"], walk1["kind"], walk1["markers"], walk2["seconds"]) == ("static", "walk", 36, 2.51)
    assert (walk1["status"], walk1["reason"], walk2["status"]) == ("failed", "why", "")
    assert told["run"]["remaining_s"] == pytest.approx(4.0 / 1.57 * 0.43)
    assert told["run"]["share"] == walk2["under_way"]["share"] == pytest.approx(0.57)
    assert (walk2["under_way"]["done"], walk2["under_way"]["total"]) == (250, 500)
    assert walk1["under_way"] is None
    assert told["notes"] == {} and told["standing_kg"] == pytest.approx(85.7, abs=0.5)
    assert answers.session(workspace, States({}), "P1")["run"] is None


def test_the_trials_of_the_body_are_stated_with_their_reasons(workspace):
    assert answers.session(workspace, States({}), "P1")["scaled_from"] == []
    record = workspace.place("P1") / RECORD
    record.parent.mkdir(parents=True)
    record.write_text(json.dumps({"scaled_from": [{"trial": "static", "part": "standing", "why": ""}],
                                  "not_scaled_from": {"walk1": "gaps"}}))  # fmt: skip
    told = answers.session(workspace, States({}), "P1")
    assert told["scaled_from"] == ["static"]
    assert told["scaled_why"] == ["scaled from static (standing)", "not scaled from walk1: gaps"]


def test_all_sessions_in_short(workspace):
    trials = {"walk1": ("failed", "why"), "walk2": ("unchanged", "")}
    told = answers.sessions(workspace, States({"P1": RunState("finished", trials=trials)}), [{"key": "k"}])
    assert told["moved"] == [{"key": "k"}]
    assert (told["sessions"][0]["failed"], told["sessions"][0]["trials"]) == (1, 2)
    assert [one["id"] for one in told["sessions"]] == ["P1"]
    assert told["sessions"][0]["run"]["state"] == "finished" and told["folder"] == str(workspace.root)


@pytest.mark.parametrize("state", ["cancelled", "failed", "not_ready"])
def test_a_session_whose_run_did_not_end_is_not_to_be_used_without_a_look(workspace, state):
    result = made_up(verdict=Verdict())
    write_reconstruction(result, summarise(result), workspace.place("P1") / "walk1")
    for name, word in (("finished", "use"), (state, "look")):
        runs = States({"P1": RunState(name, trials={"walk1": ("done", "")})})
        assert answers.sessions(workspace, runs, [])["sessions"][0]["verdict"] == word


def test_a_damaged_session_file_costs_its_session_and_is_never_written_over(workspace):
    """The session is shown with the sentence and the mend; its run fails with it, and the other one's does not."""
    shutil.copytree(workspace.root / "P1", workspace.root / "P2")
    file = workspace.root / "P1" / "session.toml"
    file.write_text("mass_kg = 71,9\n", encoding="utf-8")
    found = answers.session(workspace, States({}), "P1")
    (problem,) = [one for one in found["problems"] if one["key"] == "session_file"]
    assert "line 1: not a session file: 'mass_kg = 71,9'" in problem["what"] and problem["grave"]
    assert "text editor" in problem["todo"] and len(found["trials"]) == 3
    assert answers.session(workspace, States({}), "P2")["problems"] == []
    assert all("write mass_kg = 71.9" in trial.fault for trial in workspace.plan("P1").trials)
    assert not any(trial.fault for trial in workspace.plan("P2").trials)
    with pytest.raises(FileFormatError, match="line 1"):
        workspace.change("P1", SessionNotes(), SessionNotes(mass_kg=80.0))
    assert file.read_text(encoding="utf-8") == "mass_kg = 71,9\n"
