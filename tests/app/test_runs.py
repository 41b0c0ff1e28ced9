"""Runs of sessions: queued, watched, cancelled, taken up again; results are those of a batch."""

import json
import time

import numpy as np
import pytest

from mbkf.app import runs as module
from mbkf.app.runs import CANCELLED, FAILED, FINISHED, RUNNING, RUNS_FILE, WAITING, Runs, RunState
from mbkf.app.workspace import RESULTS, Workspace
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.session import SessionNotes
from mbkf.study.batch.outcome import Outcome, ReconstructTrial, Status
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.studies import batch_here, study

PATIENCE_S = 60.0


def wait_for(condition):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", persons=2, trials=3)
    return Workspace(tmp_path / "lab")


class Quick:
    """An executor that answers at once, without a process."""

    done: list = []  # noqa: RUF012

    def __init__(self, workers):
        self.workers = workers

    def run(self, tasks):
        for number, task in enumerate(tasks):
            if isinstance(task, ReconstructTrial):
                Quick.done.append(task.trial.name)
                failed = task.trial.name == "walk2"
                yield number, Outcome(Status.FAILED, "no markers") if failed else Outcome(Status.DONE)
            else:
                yield number, Outcome(Status.DONE, subject=task.out / "subject.toml")

    def close(self):
        pass


@pytest.fixture
def quick(monkeypatch):
    Quick.done = []
    monkeypatch.setattr(module, "LocalWorkers", Quick)


def test_results_are_those_of_a_batch(tmp_path):
    study(tmp_path / "lab", trials=2)
    workspace = Workspace(tmp_path / "lab")
    workspace.change("P1", workspace.notes("P1"), SessionNotes(mass_kg=85.0))
    runs = Runs(workspace, 2)
    runs.start("P1")
    wait_for(lambda: runs.state("P1").state == FINISHED)
    runs.close()
    assert runs.state("P1").trials == {name: ("done", "") for name in ("walk1", "walk2")}
    batch_here(workspace.root, tmp_path / "batch", ReconstructSettings())
    for name in ("walk1", "walk2"):
        found, expected = (
            read_reconstruction(folder / "P1" / name)
            for folder in (workspace.root / RESULTS, tmp_path / "batch")
        )
        for array in ("q", "tau", "foot_wrench", "sd_tau"):
            np.testing.assert_array_equal(getattr(found, array), getattr(expected, array))


@pytest.mark.usefixtures("quick")
def test_sessions_run_one_after_the_other_and_failures_are_told(workspace):
    runs = Runs(workspace, 1)
    for name in ("P1", "P2", "P1"):
        runs.start(name)
    wait_for(lambda: all((runs.state(name) or RunState()).state == FINISHED for name in ("P1", "P2")))
    state = runs.state("P2")
    assert state.trials == {"walk1": ("done", ""), "walk2": ("failed", "no markers"), "walk3": ("done", "")}
    assert (state.done, state.total, state.remaining_s) == (2, 3, None)
    assert Quick.done == ["walk1", "walk2", "walk3"] * 2
    runs.start("P2")
    wait_for(lambda: len(Quick.done) == 9 and runs.state("P2").state == FINISHED)
    runs.close()


@pytest.mark.usefixtures("quick")
def test_a_cancelled_run_keeps_what_is_done(workspace, monkeypatch):
    runs = Runs(workspace, 1)
    note = runs._note

    def cancelling(session, begin, task, found):
        if isinstance(task, ReconstructTrial):
            runs.cancel(session)
        note(session, begin, task, found)

    monkeypatch.setattr(runs, "_note", cancelling)
    runs.start("P1")
    wait_for(lambda: runs.state("P1").state == CANCELLED)
    assert runs.state("P1").trials == {"walk1": ("done", "")}
    runs.cancel("P2")
    assert runs.state("P2") is None
    runs.close()


@pytest.mark.usefixtures("quick")
def test_what_a_server_left_is_taken_up_by_the_next(workspace):
    workspace.out.mkdir()
    left = {"P1": {"state": RUNNING, "trials": {"walk1": ["done", ""]}}, "P2": {"state": CANCELLED}}
    (workspace.out / RUNS_FILE).write_text(json.dumps(left))
    runs = Runs(workspace, 1)
    wait_for(lambda: runs.state("P1").state == FINISHED)
    assert set(Quick.done) == {"walk1", "walk2", "walk3"} and runs.state("P2").state == CANCELLED
    runs.close()
    assert json.loads((workspace.out / RUNS_FILE).read_text())["P1"]["state"] == FINISHED


@pytest.mark.usefixtures("quick")
def test_a_server_that_ends_leaves_the_rest_to_the_next(workspace, monkeypatch):
    runs = Runs(workspace, 1)
    note = runs._note

    def closing(session, begin, task, found):
        runs._closing = True
        note(session, begin, task, found)

    monkeypatch.setattr(runs, "_note", closing)
    runs.start("P1")
    runs._thread.join(PATIENCE_S)
    assert json.loads((workspace.out / RUNS_FILE).read_text())["P1"]["state"] == RUNNING
    again = Runs(workspace, 1)
    wait_for(lambda: again.state("P1").state == FINISHED)
    again.close()


def test_a_session_that_cannot_run_says_why(workspace):
    for file in (workspace.root / "P1").glob("walk*"):
        file.unlink()
    runs = Runs(workspace, 1)
    runs.start("P1")
    wait_for(lambda: runs.state("P1").state == FAILED)
    assert "no moving trial" in runs.state("P1").reason
    runs.close()


@pytest.mark.parametrize(
    "text", ["", "[1]", '{"P1": 3}', '{"P1": {"other": 1}}', '{"P1": {"trials": {"a": [1]}}}']
)
def test_a_damaged_file_of_states_is_forgotten(workspace, text):
    workspace.out.mkdir()
    (workspace.out / RUNS_FILE).write_text(text)
    runs = Runs(workspace, 1)
    assert runs.state("P1") is None
    runs.close()


def test_the_remaining_time_follows_from_what_is_done():
    state = RunState(RUNNING, "trials", done=2, total=6, seconds=10.0)
    assert state.remaining_s == pytest.approx(20.0)
    assert RunState(WAITING, total=6).remaining_s is None
