"""Frames of the made walk as a live stream, for tests of the live page."""

import itertools
from contextlib import contextmanager

import numpy as np

from mbkf.stream.results.frame import LiveFrame
from tests.recordings import walk
from tests.waiting import repeating


def frame(k, lost=0):
    """The k-th frame of an endless repetition of the walk; the first marker is never seen."""
    r = walk()
    t = k % r.frames
    measured = r.measured_m[t].copy()
    measured[0] = np.nan
    return LiveFrame(
        number=k, time_s=k / r.rate_hz, q=r.q[t], v=r.v[t], torques=r.tau[t], torques_sd=r.sd_tau[t],
        wrench=r.foot_wrench[t], wrench_sd=r.foot_wrench_sd[t], plates=np.zeros((1, 6)), measured_m=measured,
        predicted_m=r.predicted_m[t], unlabelled_m=np.array([[0.3, 0.4, 1.0]]), angle_sd=r.sd_q[t],
        angle_offset=r.sd_q_offset[t], torques_offset=r.sd_tau_offset[t], wrench_offset=r.foot_wrench_sd_offset[t],
        latency_s=0.0015, lost=lost, rate_hz=r.rate_hz, tracked=True, started=k == 0,
    )  # fmt: skip


@contextmanager
def feeding(sink, period_s=0.01):
    """Gives a sink a new frame every so often, in a thread, until the block ends."""
    numbers = itertools.count()
    with repeating(lambda: sink.take(frame(next(numbers), lost=3)), period_s):
        yield
