"""Inputs of a filter on sensors alone: frames, dofs that nothing tells of, and feet at rest."""

import numpy as np

from mbkf.imu.worn_mounts import worn_mounts
from mbkf.sensors.newton_euler import NewtonEulerLaw
from mbkf.sensors.standing_feet import FOOT_REST
from mbkf.trial.inertial.motion_inputs import (
    MOST_HZ,
    MotionSettings,
    carrier,
    frame_times,
    motion_inputs,
    motion_recording,
    unobserved,
    worn_filter,
)
from mbkf.trial.inertial.motion_start import first_posture
from tests.worn import worn


def segments_worn():
    return tuple(one.name for one in worn().moving)


def test_fast_sensors_are_thinned_out():
    one = worn().moving[0]
    assert len(frame_times(one)) == one.samples and one.rate_hz < MOST_HZ


def test_dofs_of_segments_without_sensors_are_not_told():
    model = worn().model
    found = unobserved(model, ("pelvis", "right_thigh"))
    assert not found[:6].any() and not found[model.joint("right_thigh").v].any()
    assert found[model.joint("left_thigh").v].all()


def test_a_root_without_a_sensor_moves_with_the_segment_nearest_to_it():
    model, leg = worn().model, ("right_foot", "right_thigh", "right_shank")
    assert carrier(model, leg) == "right_thigh" and carrier(model, (*leg, "pelvis")) == "pelvis"
    found = unobserved(model, leg)
    assert not found[:6].any() and found[model.joint("right_thigh").v].all()
    assert not found[model.joint("right_shank").v].any()


def test_feet_rest_while_the_person_stands_and_not_while_they_swing():
    walk = worn()
    for readings, low, high in ((walk.standing, 1.0, 1.0), (walk.moving, 0.1, 0.6)):
        recording = motion_recording(
            readings, segments_worn(), walk.model, readings[0].time_s, MotionSettings()
        )
        share = recording.readings[FOOT_REST].mean()
        assert low <= share <= high and recording.markers_m.shape[1:] == (0, 3)


def test_newton_s_law_needs_both_feet():
    walk, every = worn(), segments_worn()
    for segments, holds in ((every, True), (tuple(n for n in every if n != "left_foot"), False)):
        chosen = [[one for one in r if one.name in segments] for r in (walk.standing, walk.moving)]
        known = worn_mounts(walk.model, segments, *chosen, walk.posture, True)
        first = first_posture(walk.model, segments, np.tile(walk.posture, (2, 1)), 0.01, True)
        inputs = motion_inputs(walk.model, 0.01, segments)
        filter = worn_filter(inputs, known, first, MotionSettings())
        assert any(isinstance(block, NewtonEulerLaw) for block in filter.kalman.blocks) is holds
