"""One attempt to scale: the person or the reason, and the frames that came meanwhile."""

import threading

import pytest

from mbkf.errors import NotObservable
from mbkf.stream.run.scaling_job import ScalingJob
from tests.waiting import PATIENCE_S


def failing(error):
    def scale():
        raise error

    return scale


@pytest.mark.parametrize(
    ("error", "why"),
    [(NotObservable("too few markers"), "too few markers"), (KeyError("x"), "an unforeseen KeyError: 'x'")],
)
def test_a_failure_gives_its_reason(error, why):
    job = ScalingJob(failing(error), None)
    job.wait(PATIENCE_S)
    assert job.done
    assert job.outcome() == why


def test_the_result_is_that_of_scaling_and_the_latest_frames_are_kept():
    gate = threading.Event()
    job = ScalingJob(lambda: gate.wait(PATIENCE_S) and "person", 3)
    assert not job.done
    for frame in range(5):
        job.keep(frame)
    gate.set()
    job.wait(PATIENCE_S)
    assert job.outcome() == "person"
    assert (list(job.kept), job.left_out) == ([2, 3, 4], 2)


def test_all_frames_or_none_are_kept_on_request():
    every, none = ScalingJob(lambda: "person", None), ScalingJob(lambda: "person", 0)
    for frame in range(200):
        every.keep(frame)
        none.keep(frame)
    assert (len(every.kept), every.left_out) == (200, 0)
    assert (len(none.kept), none.left_out) == (0, 200)
