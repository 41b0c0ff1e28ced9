"""Magnetometers before any motion is known: legs show headings, and no way of strapping sensors on matters."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.imu.frames import attitude
from mbkf.imu.heading import turned
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.trial.inertial.disturbed_magnetometers import (
    at_times,
    disturbed_magnetometers,
    free_orientations,
    leg_swings,
    turning_rates,
)
from tests.worn import worn


@pytest.fixture(scope="module")
def walk():
    return worn()


def by_fields(moving, standing):
    """Orientations by gravity and field, walking and standing."""
    found = orientations(moving, frame="NWU", settings=OrientSettings("smooth"))
    means = [(one.specific_force_mps2.mean(axis=0), one.magnetic_field.mean(axis=0)) for one in standing]
    return np.stack([one.quaternion for one in found], axis=1), np.array([attitude(*one) for one in means])


def accused(walk, change):
    moving, standing = ([change(one) for one in readings] for readings in (walk.moving, walk.standing))
    known = walk.model, [one.name for one in moving], moving
    return [one.sensor for one in disturbed_magnetometers(*known, *by_fields(moving, standing))]


def field_turned(one, angle):
    """The sensor in a field that iron turns about the vertical."""
    R = quaternion_matrices(one.orientation)
    about = Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
    return replace(
        one, magnetic_field=(R.swapaxes(1, 2) @ (about @ R @ one.magnetic_field[..., None]))[..., 0]
    )


def strapped_on_turned(one, angle):
    """The sensor turned on its segment."""
    R = Rotation.from_rotvec(angle * np.array([0.3, -0.5, 0.8])).as_matrix()
    return replace(
        one,
        specific_force_mps2=one.specific_force_mps2 @ R,
        angular_velocity_rad_s=one.angular_velocity_rad_s @ R,
        magnetic_field=one.magnetic_field @ R,
        orientation=None,
    )


def test_sound_ones_are_not_accused_however_they_are_strapped_on(walk):
    assert accused(walk, lambda one: one) == []
    assert accused(walk, lambda one: strapped_on_turned(one, float(len(one.name)))) == []


@pytest.mark.parametrize(("name", "angle"), [("left_shank", 2.8), ("right_foot", 2.8), ("right_thigh", 1.4)])
def test_a_leg_in_a_turned_field_is_named(walk, name, angle):
    assert accused(walk, lambda one: field_turned(one, angle) if one.name == name else one) == [name]


def test_legs_swing_about_the_left_and_others_do_not(walk):
    q, upright = by_fields(walk.moving, walk.standing)
    segments, times = [one.name for one in walk.moving], walk.moving[0].time_s
    swing = leg_swings(walk.model, segments, q, turning_rates(q, times), upright)
    assert [name for name, one in zip(segments, swing, strict=True) if one is None] == ["pelvis", "torso"]
    told = {
        name: one for name, one in zip(segments, swing, strict=True) if one is not None and one.points_left
    }
    assert set(told) == {"right_shank", "left_shank", "right_foot", "left_foot"}
    forward = walk.motion.q[-1, :2] - walk.motion.q[0, :2]
    left = np.arctan2(forward[0], -forward[1])
    off = np.angle(np.exp(1j * (np.array([one.axis_rad for one in told.values()]) - left)))
    assert np.abs(off).max() < 0.4
    still = leg_swings(walk.model, segments, q, np.zeros((len(q), 8, 3)), upright)
    assert still == [None] * len(segments)


def test_free_orientations_share_the_vertical_only(walk):
    found = free_orientations(walk.moving, walk.moving[0].time_s)
    for k, one in enumerate(walk.moving):
        up, true = (quaternion_matrices(q)[:, 2] for q in (found[:, k], one.orientation))
        assert np.degrees(np.arccos(np.clip((up * true).sum(axis=1), -1.0, 1.0))).mean() < 4.0


def test_orientations_at_other_times_bridge_what_is_missing():
    times = np.arange(5.0)
    course = turned(np.tile([0.0, 0.0, 0.0, 1.0], (5, 1, 1)), 0.1 * times[:, None])[:, 0]
    lost = course.copy()
    lost[2] = np.nan
    np.testing.assert_allclose(at_times(times, lost, times), course, atol=1e-12)
    assert at_times(times, course, times) is course
