"""Workers give every task's outcome once; a killed one costs only the task that it died of."""

import contextlib
import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mbkf.study.batch import workers as module
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.worker_process import KILLED
from mbkf.study.batch.workers import LocalWorkers
from tests.batch_tasks import Answer, Die, Endless, Fail, Large, Stop
from tests.waiting import PATIENCE_S


@pytest.fixture(scope="module", params=[1, 2])
def workers(request):
    made = LocalWorkers(request.param)
    yield made
    made.close()


def test_every_task_is_answered_once_and_told_by_its_place(workers, tmp_path):
    found = list(workers.run(Answer(k, tmp_path) for k in range(25)))
    assert sorted(number for number, _ in found) == list(range(25))
    assert all(outcome.reason == str(number) for number, outcome in found)
    done = [int(path.name.split("-")[0]) for path in tmp_path.iterdir()]
    assert sorted(done) == list(range(25))
    assert all(int(path.name.split("-")[1]) != os.getpid() for path in tmp_path.iterdir())


def test_tasks_are_asked_for_as_they_are_needed(workers, tmp_path):
    asked = 0

    def tasks():
        nonlocal asked
        for k in range(40):
            asked += 1
            yield Answer(k, tmp_path)

    running = workers.run(tasks())
    next(running)
    assert asked <= 2 * workers._workers
    assert len(list(running)) == 39


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_a_worker_that_is_killed_costs_only_its_task(workers, tmp_path):
    deadly = {3, 11} if workers._workers > 1 else {3}
    tasks = [Answer(k, tmp_path) if k not in deadly else Die() for k in range(16)]
    found = dict(workers.run(tasks))
    assert sorted(found) == list(range(16))
    assert {k for k, outcome in found.items() if outcome.status == Status.FAILED} == deadly
    assert all(found[k].reason == KILLED for k in deadly)
    assert all(found[k].reason == str(k) for k in range(16) if k not in deadly)
    assert len(list(workers.run([Answer(99, tmp_path)]))) == 1


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_the_signal_that_ended_a_worker_is_named(workers):
    found = dict(workers.run([Die(signal.SIGSEGV)]))
    assert found[0] == Outcome(Status.FAILED, "the worker ended by SIGSEGV while it did this")


def test_an_error_that_no_task_should_raise_becomes_a_reason(workers, tmp_path):
    found = dict(workers.run([Fail(), Answer(1, tmp_path)]))
    assert found[0].status == Status.FAILED and "nobody foresaw this" in found[0].reason
    assert found[1].status == Status.DONE


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
@pytest.mark.parametrize("always", [False, True])
def test_a_worker_that_is_stopped_is_replaced_and_its_task_done_again(tmp_path, monkeypatch, always):
    monkeypatch.setattr(module, "STILL_S", 1.5)
    workers = LocalWorkers(2)
    found = dict(workers.run([Answer(0, tmp_path), Stop(tmp_path, always), Answer(2, tmp_path)]))
    assert [found[k].reason for k in (0, 2)] == ["0", "2"]
    assert found[1].status == (Status.FAILED if always else Status.DONE)
    assert ("no sign of life" in found[1].reason) == always
    workers.close()
    assert not workers._living


class GivenUp(Exception):
    """A run is given up."""


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_a_run_that_is_given_up_ends_its_workers_with_it(workers, tmp_path):
    stages = []

    def watch(under_way):
        stages.append(under_way)
        if any(one.done > 5 for one in under_way.values()):
            raise GivenUp

    with pytest.raises(GivenUp):
        list(workers.run([Endless(tmp_path), Endless(tmp_path)], watch))
    numbers = [int(path.name.split("-")[1]) for path in tmp_path.iterdir()]
    assert numbers and not any(lives(number) for number in numbers)
    assert {one.stage for one in stages[-1].values()} <= {"", "Waiting"}
    assert len(list(workers.run([Answer(99, tmp_path)]))) == 1


def test_a_worker_whose_memory_has_grown_is_replaced(tmp_path):
    workers = LocalWorkers(1)
    found = dict(workers.run([Large(), Large(), Answer(2, tmp_path)]))
    assert found[0].reason != found[1].reason
    workers.close()


def test_no_task_is_no_outcome(workers):
    assert list(workers.run([])) == []


ORPHANED = """
import sys, time
from pathlib import Path
from mbkf.study.batch.workers import LocalWorkers
from tests.batch_tasks import Answer
workers = LocalWorkers(2)
list(workers.run(Answer(k, Path(sys.argv[1])) for k in range(8)))
print("ready", flush=True)
time.sleep(60)
"""


def lives(number):
    """Whether a process runs; one that has ended and is not asked for by its parent does not."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def ended(number):
    """Waits for the end of another's process."""
    with contextlib.suppress(ProcessLookupError):
        handle = os.pidfd_open(number)
        found, _, _ = select.select([handle], [], [], PATIENCE_S)
        os.close(handle)
        assert found, f"process {number} still runs"


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_workers_end_after_a_parent_that_was_killed(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-c", ORPHANED, str(tmp_path)], stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout.readline() == "ready\n"
        numbers = {int(path.name.split("-")[1]) for path in tmp_path.iterdir()}
        assert numbers and all(lives(number) for number in numbers)
        parent.kill()
    for number in numbers:
        ended(number)
