"""Recordings: frames in, the same frames out."""

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.sensors.block import Frame


def test_a_recording_of_frames_gives_them_back():
    rng = np.random.default_rng(0)
    frames = [
        Frame(
            rng.normal(size=(4, 3)),
            rng.normal(size=(2, 6)),
            rng.normal(size=(3, 6)),
            {"own": rng.normal(size=2)},
        )
        for _ in range(3)
    ]
    for some in (frames, frames[:1]):
        found = Recording.of(some, 0.01)
        assert (len(found), found.dt_s) == (len(some), 0.01)
        for t, frame in enumerate(some):
            again = found.frame(t)
            for one, other in zip(again[:3], frame[:3], strict=True):
                np.testing.assert_array_equal(one, other)
            np.testing.assert_array_equal(again.readings["own"], frame.readings["own"])


def test_instruments_that_are_not_there_stay_away():
    found = Recording.of([Frame(np.zeros((4, 3)), np.zeros((0, 6)))], 0.01).frame(0)
    assert found.imus is None and not found.readings
