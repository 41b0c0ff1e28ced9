"""The misfit is least for sensors as they are worn, and standing before a movement is not looked at."""

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.imu.worn_mounts import worn_mounts
from mbkf.trial.inertial.misfit import LOOKED_AT_S, looked_at, misfit
from mbkf.trial.inertial.motion_inputs import MotionSettings, motion_inputs, motion_recording, worn_filter
from mbkf.trial.inertial.motion_start import first_posture
from tests.worn import worn


def test_sensors_the_other_way_round_fit_worse():
    one = worn("squat", 2.0)
    segments, settings = tuple(sensor.name for sensor in one.moving), MotionSettings()
    inputs = motion_inputs(one.model, 0.01, segments)
    recording = motion_recording(one.moving, segments, one.model, one.motion.times_s, settings)
    first = first_posture(one.model, segments, one.motion.q[:2], 0.01, True)
    found = []
    for turned in ((), ("right_thigh", "left_thigh", "right_shank", "left_shank"), ("pelvis",)):
        known = worn_mounts(one.model, segments, one.standing, one.moving, one.posture, True, turned=turned)
        filter = worn_filter(inputs, known, first, settings, one.posture)
        found.append(misfit(filter, recording))
        assert misfit(filter, recording, 1.001 * found[-1]) == found[-1]
        assert misfit(filter, recording, 0.999 * found[-1]) == np.inf
    assert found[0] < 0.6 * min(found[1:])


def test_a_misfit_far_beyond_the_bound_is_left_off_early(monkeypatch):
    one = worn("squat", 2.0)
    segments, settings = tuple(sensor.name for sensor in one.moving), MotionSettings()
    inputs = motion_inputs(one.model, 0.01, segments)
    recording = motion_recording(one.moving, segments, one.model, one.motion.times_s, settings)
    first = first_posture(one.model, segments, one.motion.q[:2], 0.01, True)
    known = worn_mounts(one.model, segments, one.standing, one.moving, one.posture, True)
    filter, steps = worn_filter(inputs, known, first, settings, one.posture), []
    step = filter.step
    monkeypatch.setattr(filter, "step", lambda *known: steps.append(known) or step(*known))
    assert misfit(filter, recording, 0.1 * misfit(filter, recording)) == np.inf
    assert len(steps) < 1.6 * len(recording)


def test_standing_before_a_movement_does_not_count():
    imus = np.zeros((2000, 2, 6))
    imus[900:, 1, 0] = 2.0
    still, none = (
        Recording(np.zeros((len(x), 0, 3)), np.zeros((len(x), 0, 6)), 0.01, x) for x in (imus, imus[:700])
    )
    assert looked_at(still) == 900 + round(LOOKED_AT_S / 0.01)
    assert looked_at(none) == round(LOOKED_AT_S / 0.01)
