"""A worker's process speaks with its parent, and its end is told with the reason."""

import os
import signal
from queue import SimpleQueue

import pytest

from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.worker_process import KILLED, Gone, WorkerProcess, _reason
from tests.batch_tasks import Answer, Die
from tests.waiting import PATIENCE_S


def next_but_beats(inbox, worker):
    while True:
        sender, message = inbox.get(timeout=PATIENCE_S)
        assert sender is worker
        if message is not None:
            return message


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_outcomes_come_until_it_dies(tmp_path):
    inbox = SimpleQueue()
    worker = WorkerProcess(inbox)
    worker.give(Answer(7, tmp_path))
    assert next_but_beats(inbox, worker) == Outcome(Status.DONE, "7")
    worker.give(Die(signal.SIGTERM))
    assert isinstance(next_but_beats(inbox, worker), Gone)
    assert worker.end() == "the worker ended by SIGTERM while it did this"
    assert not worker._thread.is_alive() and worker._process.stdin.closed


def test_it_can_be_ended_at_once_and_twice():
    worker = WorkerProcess(SimpleQueue())
    assert worker.end() == KILLED == worker.end()


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (None, KILLED),
        (-9, KILLED),
        (-11, "the worker ended by SIGSEGV while it did this"),
        (-63, "the worker ended by signal 63 while it did this"),
        (3, "the worker ended with status 3 while it did this"),
    ],
)
def test_every_end_has_a_sentence(code, reason):
    assert _reason(code) == reason
