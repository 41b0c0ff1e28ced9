"""Runs of sessions: queued, watched, cancelled, taken up again; results are those of a batch."""

import errno
import json
import os
import threading
from pathlib import Path

import numpy as np
import pytest

from mbkf.app import runs as module
from mbkf.app.run_states import CANCELLED, FAILED, FINISHED, NOT_READY, RUNNING, WAITING, RunState
from mbkf.app.runs import RUNS_FILE, Runs
from mbkf.app.workspace import RESULTS, Workspace
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.session import SESSION_FILE, SessionNotes
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.progress import Progress
from mbkf.study.batch.tasks import ReconstructTrial
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.studies import batch_here, study
from tests.waiting import PATIENCE_S


def wait_for(runs, session, *states):
    """Waits for the end of a session's run, or another state."""
    assert runs.wait(lambda: getattr(runs.state(session), "state", None) in states, PATIENCE_S), runs.state(
        session
    )
    return runs.state(session)


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", persons=2, trials=3)
    return Workspace(tmp_path / "lab")


class Quick:
    """An executor that answers at once, without a process."""

    done: list = []  # noqa: RUF012
    begin = threading.Event()

    def __init__(self, workers):
        self.workers = workers

    def run(self, tasks, watch=None):
        assert Quick.begin.wait(PATIENCE_S)
        for number, task in enumerate(tasks):
            watch({number: Progress("Filtering", 1, 2)})
            if isinstance(task, ReconstructTrial):
                Quick.done.append(task.trial.name)
                failed = task.trial.name == "walk2"
                yield number, Outcome(Status.FAILED, "no markers") if failed else Outcome(Status.DONE)
            else:
                yield number, Outcome(Status.DONE, subject=task.out / "subject.toml")

    def close(self):
        pass


class Slow(Quick):
    """Tasks under way until the run is given up: they report their progress again and again."""

    closed = 0

    def run(self, tasks, watch=None):
        for number, task in enumerate(tasks):
            while isinstance(task, ReconstructTrial):
                watch({number: Progress("Filtering", 1, 4)})
            yield number, Outcome(Status.DONE, subject=task.out / "subject.toml")

    def close(self):
        Slow.closed += 1


@pytest.fixture
def quick(monkeypatch):
    Quick.done = []
    Quick.begin.set()
    monkeypatch.setattr(module, "LocalWorkers", Quick)


@pytest.fixture
def slow(monkeypatch):
    Slow.closed = 0
    monkeypatch.setattr(module, "LocalWorkers", Slow)


def test_results_are_those_of_a_batch(tmp_path):
    study(tmp_path / "lab", trials=1)
    workspace = Workspace(tmp_path / "lab")
    workspace.change("P1", workspace.notes("P1"), SessionNotes(mass_kg=85.0))
    runs = Runs(workspace, 1)
    runs.start("P1")
    wait_for(runs, "P1", FINISHED)
    runs.close()
    assert runs.state("P1").trials == {"walk1": ("done", "")}
    batch_here(workspace.root, tmp_path / "batch", ReconstructSettings())
    found, expected = (
        read_reconstruction(folder / "P1" / "walk1")
        for folder in (workspace.root / RESULTS, tmp_path / "batch")
    )
    for array in ("q", "tau", "foot_wrench", "sd_tau"):
        np.testing.assert_array_equal(getattr(found, array), getattr(expected, array))


@pytest.mark.usefixtures("quick")
def test_sessions_run_one_after_the_other_and_failures_are_told(workspace):
    Quick.begin.clear()
    runs = Runs(workspace, 1)
    for name in ("P1", "P2", "P1"):
        runs.start(name)
    Quick.begin.set()
    for name in ("P1", "P2"):
        wait_for(runs, name, FINISHED)
    state = runs.state("P2")
    assert state.trials == {"walk1": ("done", ""), "walk2": ("failed", "no markers"), "walk3": ("done", "")}
    assert (state.done, state.total, state.remaining_s) == (2, 3, None)
    assert Quick.done == ["walk1", "walk2", "walk3"] * 2
    runs.start("P2")
    wait_for(runs, "P2", FINISHED)
    assert len(Quick.done) == 9
    runs.close()


@pytest.mark.usefixtures("quick")
def test_a_cancelled_run_keeps_what_is_done(workspace, monkeypatch):
    class Cancelling(Quick):
        def run(self, tasks, watch=None):
            for number, outcome in super().run(tasks, watch):
                yield number, outcome
                if Quick.done == ["walk1"]:
                    runs.cancel("P1")

    monkeypatch.setattr(module, "LocalWorkers", Cancelling)
    runs = Runs(workspace, 1)
    runs.start("P1")
    wait_for(runs, "P1", CANCELLED)
    runs.start("P2")
    wait_for(runs, "P2", FINISHED)
    assert runs.state("P1").trials == {"walk1": ("done", "")} and runs.state("P1").state == CANCELLED
    runs.cancel("P3")
    assert runs.state("P3") is None
    runs.close()


@pytest.mark.usefixtures("slow")
def test_a_run_is_cancelled_inside_a_trial_and_may_start_again_at_once(workspace):
    runs = Runs(workspace, 1)
    for _ in range(3):
        runs.start("P1")
        assert runs.wait(lambda: bool(runs.state("P1").under_way), PATIENCE_S)
        assert runs.state("P1").under_way == {"walk1": Progress("Filtering", 1, 4)}
        runs.cancel("P1")
        assert runs.state("P1").state == CANCELLED
    runs.start("P1")
    runs.start("P2")
    runs.cancel("P1")
    wait_for(runs, "P2", RUNNING)
    assert runs.state("P1").state == CANCELLED
    runs.close()
    assert Slow.closed >= 3 and not runs._thread.is_alive()


@pytest.mark.usefixtures("slow")
def test_a_server_that_ends_leaves_the_rest_to_the_next(workspace, monkeypatch):
    runs = Runs(workspace, 1)
    runs.start("P1")
    assert runs.wait(lambda: bool(runs.state("P1").under_way), PATIENCE_S)
    runs.close()
    assert not runs._thread.is_alive()
    assert json.loads((workspace.out / RUNS_FILE).read_text())["P1"]["state"] == RUNNING
    monkeypatch.setattr(module, "LocalWorkers", Quick)
    again = Runs(workspace, 1)
    wait_for(again, "P1", FINISHED)
    again.close()


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left"), MemoryError(), KeyError("odd")])
@pytest.mark.parametrize("place", ["outcomes_of", "sweep_plan", "asdict", "LocalWorkers", "Workspace.plan"])
def test_whatever_goes_wrong_in_a_run_ends_that_run_alone(workspace, monkeypatch, place, error):
    runs = Runs(workspace, 1)

    def broken(*_, **__):
        raise error

    with monkeypatch.context() as patch:
        patch.setattr(
            *((Workspace, "plan", broken) if place == "Workspace.plan" else (module, place, broken))
        )
        runs.start("P1")
        # where only the states cannot be written, the run itself succeeds
        wait_for(runs, "P1", FINISHED if place == "asdict" else FAILED)
    expected = "No space left" if isinstance(error, OSError) else type(error).__name__
    assert place == "asdict" or expected in runs.state("P1").reason
    runs.start("P2")
    wait_for(runs, "P2", FINISHED)
    runs.close()


@pytest.mark.usefixtures("quick")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_thread_that_could_not_even_fail_is_started_again(workspace, monkeypatch):
    def broken(*_):
        raise MemoryError

    runs = Runs(workspace, 1)
    with monkeypatch.context() as patch:
        patch.setattr(runs, "_run_one", broken)
        patch.setattr(runs, "_fail", broken)
        runs.start("P1")
        runs._thread.join(PATIENCE_S)
        assert not runs._thread.is_alive()
    assert runs.state("P1").state == FAILED and "unknown reason" in runs.state("P1").reason
    for name in ("P1", "P2"):
        runs.start(name)
        wait_for(runs, name, FINISHED)
    runs.close()


@pytest.mark.usefixtures("quick")
def test_a_thread_that_ends_while_somebody_waits_is_started_again(workspace, monkeypatch):
    ends, looks = threading.Event(), []
    with monkeypatch.context() as patch:
        patch.setattr(Runs, "_run", lambda _: ends.wait())
        runs = Runs(workspace, 1)
        runs.start("P1")

    def finished():
        looks.append(None)
        ends.set()  # from here on the thread ends, and nothing changes by itself
        return runs._states["P1"].state == FINISHED

    assert runs.wait(finished, PATIENCE_S)
    assert len(looks) > 1
    runs.close()


def test_a_wait_in_vain_ends(workspace):
    runs = Runs(workspace, 1)
    assert not runs.wait(lambda: False, 0.0)
    runs.close()


@pytest.mark.usefixtures("quick")
def test_a_full_disk_costs_the_file_of_states_alone(workspace, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "runs.json")

    monkeypatch.setattr(module, "write_text", full)
    runs = Runs(workspace, 1)
    for name in ("P1", "P2"):
        runs.start(name)
        wait_for(runs, name, FINISHED)
    runs.close()
    assert not (workspace.out / RUNS_FILE).exists()


@pytest.mark.usefixtures("quick")
def test_what_a_server_left_is_taken_up_by_the_next(workspace):
    workspace.out.mkdir()
    left = {"P1": {"state": RUNNING, "trials": {"walk1": ["done", ""]}}, "P2": {"state": CANCELLED}}
    (workspace.out / RUNS_FILE).write_text(json.dumps(left))
    runs = Runs(workspace, 1)
    wait_for(runs, "P1", FINISHED)
    assert set(Quick.done) == {"walk1", "walk2", "walk3"} and runs.state("P2").state == CANCELLED
    runs.close()
    assert json.loads((workspace.out / RUNS_FILE).read_text())["P1"]["state"] == FINISHED


def test_a_session_that_cannot_run_says_why(workspace):
    for file in (workspace.root / "P1").glob("walk*"):
        file.unlink()
    runs = Runs(workspace, 1)
    runs.start("P1")
    wait_for(runs, "P1", FAILED)
    assert "no moving trial" in runs.state("P1").reason
    runs.close()


@pytest.mark.usefixtures("quick")
def test_all_sessions_run_in_their_order_and_those_that_are_not_ready_say_why(workspace):
    for name, source in (("P0", "P1/static.c3d"), ("P9/S01", "P1/walk1.c3d"), ("P9/S01", "P1/static.c3d")):
        (workspace.root / name).mkdir(parents=True, exist_ok=True)
        (workspace.root / name / Path(source).name).write_bytes((workspace.root / source).read_bytes())
    (workspace.root / "P9" / "S01" / SESSION_FILE).write_text("mass_kg = oak\n")
    Quick.begin.clear()
    runs = Runs(workspace, 1)
    runs.start("P2")
    wait_for(runs, "P2", RUNNING)
    runs.start_all()
    states = {name: runs.state(name).state for name in workspace.sessions()}
    assert states == {"P0": NOT_READY, "P1": WAITING, "P2": RUNNING, "P9/S01": NOT_READY}
    assert "no moving trial" in runs.state("P0").reason and SESSION_FILE in runs.state("P9/S01").reason
    Quick.begin.set()
    wait_for(runs, "P1", FINISHED)
    Quick.begin.clear()
    runs.start_all()
    Quick.begin.set()
    wait_for(runs, "P2", FINISHED)
    assert list(json.loads((workspace.out / RUNS_FILE).read_text())) == list(workspace.sessions())
    runs.close()


@pytest.mark.usefixtures("slow")
def test_all_runs_end_together(workspace):
    runs = Runs(workspace, 1)
    runs.start_all()
    assert runs.wait(lambda: bool(runs.state("P1").under_way), PATIENCE_S)
    runs.cancel(*workspace.sessions())
    assert [runs.state(name).state for name in ("P1", "P2")] == [CANCELLED, CANCELLED]
    runs.close()
    assert not runs.state("P2").seconds and Slow.closed == 1


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[1]",
        '{"P1": 3}',
        '{"P1": {"other": 1}}',
        '{"P1": {"trials": {"a": [1]}}}',
        '{"P1": {"persons": ["a.c3d"]}}',
    ],
)
def test_a_damaged_file_of_states_is_forgotten(workspace, text):
    workspace.out.mkdir()
    (workspace.out / RUNS_FILE).write_text(text)
    runs = Runs(workspace, 1)
    assert runs.state("P1") is None
    runs.close()


@pytest.mark.usefixtures("quick")
def test_a_file_of_others_with_the_name_of_the_states_stays(workspace):
    workspace.out.mkdir()
    (workspace.out / RUNS_FILE).write_text("12 km on Monday")
    runs = Runs(workspace, 1)
    runs.start("P1")
    wait_for(runs, "P1", FINISHED)
    runs.close()
    assert (workspace.out / RUNS_FILE).read_text() == "12 km on Monday"


def test_the_remaining_time_follows_from_what_is_done():
    state = RunState(RUNNING, "trials", done=2, total=6, seconds=12.0, scaled_s=2.0)
    assert state.remaining_s == pytest.approx(20.0)
    assert RunState(WAITING, total=6).remaining_s is None
    assert RunState(RUNNING, total=6, seconds=2.0).remaining_s is None


def test_the_remaining_time_is_known_inside_a_trial():
    state = RunState(RUNNING, "trials", total=1, seconds=10.0, scaled_s=1.0)
    remaining = []
    for stage in (
        Progress("Filtering", 100, 1000),
        Progress("Filtering", 900, 1000),
        Progress("Writing", 0, 1),
    ):
        state.under_way = {"walk1": stage}
        remaining.append(state.remaining_s)
    assert remaining == sorted(remaining, reverse=True) and 0.0 < remaining[-1] < 3.0
    assert remaining[0] == pytest.approx(9.0 / 0.29 * 0.71)
