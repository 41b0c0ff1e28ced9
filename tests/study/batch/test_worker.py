"""A worker's process answers every task with an outcome, whatever happens, and reports progress now and then."""

import io
import pickle
import subprocess
import sys

import pytest

from mbkf.study.batch import worker as module
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.progress import Progress
from mbkf.study.batch.worker import BEAT, GARBAGE_AFTER, Line, answer
from mbkf.study.batch.worker_process import PROGRAM
from tests.batch_tasks import Answer, Fail, Threshold
from tests.waiting import PATIENCE_S


def messages(sink):
    sink.seek(0)
    found = []
    while True:
        try:
            found.append(pickle.load(sink))
        except EOFError:
            return found


@pytest.mark.parametrize(
    ("packed", "reason"),
    [
        (pickle.dumps(Fail()), "nobody foresaw this"),
        (b"no pickle", "unforeseen"),
        (pickle.dumps(Answer)[:-9] + b"Missing\x94.", "unforeseen"),
    ],
)
def test_an_error_is_an_outcome(packed, reason):
    found = answer(packed, Line(io.BytesIO()))
    assert found.status == Status.FAILED and reason in found.reason


def test_a_stage_is_sent_at_its_begin_and_then_now_and_then(monkeypatch):
    now, sink = [0.0], io.BytesIO()
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    line = Line(sink)
    for done in range(10):
        line.progress("Filtering", done, 10)
        now[0] += 0.0625
    line.progress("Writing", 0, 1)
    assert messages(sink) == [
        Progress("Filtering", 0, 10),
        Progress("Filtering", 4, 10),
        Progress("Filtering", 8, 10),
        Progress("Writing", 0, 1),
    ]


def test_a_task_comes_in_and_its_outcome_goes_out_until_the_input_closes(tmp_path):
    words = [sys.executable, "-c", PROGRAM]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        for number in range(2):
            pickle.dump(pickle.dumps(Answer(number, tmp_path)), process.stdin)
            process.stdin.flush()
            while (found := pickle.load(process.stdout)) is BEAT:
                pass
            assert found == Outcome(Status.DONE, str(number))
        process.stdin.close()
        assert process.wait(PATIENCE_S) == 1


def test_circles_among_what_libraries_made_are_not_looked_for_in_every_task():
    words = [sys.executable, "-c", PROGRAM]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        pickle.dump(pickle.dumps(Threshold()), process.stdin)
        process.stdin.flush()
        while (found := pickle.load(process.stdout)) is BEAT:
            pass
        assert found == Outcome(Status.DONE, str(GARBAGE_AFTER))
