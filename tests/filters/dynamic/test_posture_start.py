"""A filter on sensors alone starts from the posture that is told, and is not thought to see where the body is."""

import numpy as np

from mbkf.imu.worn_mounts import worn_mounts
from mbkf.trial.inertial.motion_inputs import MotionSettings, motion_inputs, motion_recording, worn_filter
from mbkf.trial.inertial.motion_start import first_posture
from tests.worn import worn


def test_it_starts_where_it_is_told_and_later_frames_may_move_it():
    one = worn("squat", 2.0)
    segments = tuple(sensor.name for sensor in one.moving)
    known = worn_mounts(one.model, segments, one.standing, one.moving, one.posture, True)
    first = first_posture(one.model, segments, one.motion.q[:2], 0.01, True)
    inputs = motion_inputs(one.model, 0.01, segments)
    filter = worn_filter(inputs, known, first, MotionSettings(), one.posture)
    recording = motion_recording(one.moving, segments, one.model, one.motion.times_s, MotionSettings())
    started = filter.start(recording, 0, None)
    assert started.started and started.tracked
    told = ~inputs.unobservable
    np.testing.assert_allclose(one.model.difference(first.q, started.q)[told], 0.0, atol=0.02)
    after = filter.step(started, recording, 1)
    assert after.tracked and not after.placed
