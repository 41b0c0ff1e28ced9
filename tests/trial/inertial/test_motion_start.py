"""The first posture stands on the floor with its lower foot at rest, and is known as sensors know it."""

import numpy as np
import pytest

from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.trial.inertial.motion_start import StartSettings, first_posture
from tests.worn import worn

SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot", "left_thigh", "left_shank", "left_foot")


def test_the_lower_foot_is_on_the_floor_and_does_not_move():
    walk = worn()
    q, dt = walk.motion.q[40:42], 0.01
    first = first_posture(walk.model, SEGMENTS, q, dt, False)
    feet = FeetOnBody(walk.model).at(first.q, first.v)
    ends = [(foot, point) for foot in (0, 1) for point in feet.soles[foot]]
    foot, low = min(ends, key=lambda end: end[1][2])
    assert low[2] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(feet.velocity(foot, low), 0.0, atol=1e-9)
    # The true walk's pelvis moves as this says: forward at about its speed.
    forward = walk.motion.v[40, :3]
    assert np.linalg.norm(first.v[:3] - forward) < 0.5 * np.linalg.norm(forward)


def test_tilts_and_headings_of_segments_are_known_as_stated():
    walk, s = worn(), StartSettings()
    first = first_posture(walk.model, SEGMENTS, np.tile(walk.posture, (2, 1)), 0.01, True)
    _, spatial = walk.model.frames_and_jacobian(first.q)
    nv = walk.model.nv
    for name in SEGMENTS[1:]:
        turns = spatial[3:] * walk.model.supports[walk.model.joint(name).joint_id]
        sd = np.sqrt(np.diag(turns @ first.P[:nv, :nv] @ turns.T))
        assert (sd <= np.array([s.tilt_sd_rad, s.tilt_sd_rad, s.heading_sd_rad]) * 1.0001).all()
        assert sd[2] > 0.5 * s.heading_sd_rad
    assert not first.v.any()
