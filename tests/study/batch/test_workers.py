"""Workers give every task's outcome once; a killed one costs only the task that it died of."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mbkf.study.batch.outcome import Status
from mbkf.study.batch.workers import AHEAD, KILLED, LocalWorkers
from tests.batch_tasks import Answer, Die


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
    assert asked <= 2 * AHEAD + 1
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


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_workers_end_after_a_parent_that_was_killed(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-c", ORPHANED, str(tmp_path)], stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout.readline() == "ready\n"
        numbers = {int(path.name.split("-")[1]) for path in tmp_path.iterdir()}
        assert numbers and all(lives(number) for number in numbers)
        parent.kill()
    until = time.monotonic() + 20.0
    while any(lives(number) for number in numbers) and time.monotonic() < until:
        time.sleep(0.1)
    assert not any(lives(number) for number in numbers)
