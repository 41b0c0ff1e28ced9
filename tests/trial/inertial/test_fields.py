"""Fields compared: a magnetometer that is turned, weak or in iron is named, whichever it is, and no other."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.imu.readings import ImuReadings
from mbkf.trial.inertial.fields import (
    Swing,
    disturbed_fields,
    fields_unlike_others,
    most_central,
    world_field,
)

FIELD = np.array([24.0, 3.0, -39.0])


def worn(count=8, seed=0):
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        R = Rotation.random(50, random_state=seed + k).as_matrix()
        local = Rotation.from_rotvec(np.radians(8.0) * rng.normal(size=3)).apply(FIELD) * rng.uniform(
            0.9, 1.1
        )
        field = local @ R + 0.3 * rng.normal(size=(50, 3))
        found.append(
            (ImuReadings(f"s{k}", np.arange(50) / 50, np.zeros((50, 3)), np.zeros((50, 3)), field, 50.0), R)
        )
    return found


def changed(one, field):
    return ImuReadings(
        one.name, one.time_s, one.specific_force_mps2, one.angular_velocity_rad_s, field, one.rate_hz
    )


@pytest.mark.parametrize("k", range(8))
@pytest.mark.parametrize("how", ["turned", "weak"])
def test_the_bad_one_is_named(k, how):
    sensors = worn(seed=k)
    one, R = sensors[k]
    field = one.magnetic_field
    bad = 0.3 * field if how == "weak" else field[:, [1, 0, 2]] * [1.0, -1.0, 1.0]
    sensors[k] = (changed(one, bad), R)
    (found,) = disturbed_fields(*zip(*sensors, strict=True))
    assert found.sensor == f"s{k}" and f"s{k}" in found.remark
    if how == "weak":
        assert found.size == pytest.approx(0.3, abs=0.06)


def test_good_ones_are_not_accused_and_two_do_not_judge():
    sensors = worn()
    assert disturbed_fields(*zip(*sensors, strict=True)) == ()
    one, R = sensors[0]
    assert (
        disturbed_fields(*zip(*[(changed(one, 0.1 * one.magnetic_field), R), sensors[1]], strict=True)) == ()
    )


def upside(sensors):
    """The same sensors, each in a world of its own that shares but the vertical."""
    rng = np.random.default_rng(5)
    turns = Rotation.from_rotvec(rng.uniform(-3, 3, len(sensors))[:, None] * [0.0, 0.0, 1.0]).as_matrix()
    return [(one, turn @ R) for (one, R), turn in zip(sensors, turns, strict=True)]


@pytest.mark.parametrize("k", [0, 3, 5])
def test_size_and_dip_are_compared_without_headings(k):
    sensors, none = upside(worn(seed=k)), [None] * 8
    assert fields_unlike_others(*zip(*sensors, strict=True), none) == ()
    one, R = sensors[k]
    for field in (0.3 * one.magnetic_field, one.magnetic_field[:, [1, 0, 2]] * [1.0, -1.0, 1.0]):
        bad = [*sensors]
        bad[k] = (changed(one, field), R)
        assert [found.sensor for found in fields_unlike_others(*zip(*bad, strict=True), none)] == [f"s{k}"]


@pytest.mark.parametrize(
    ("k", "off_deg", "found"), [(2, 70.0, True), (2, 25.0, False), (2, 160.0, False), (4, 160.0, True)]
)
def test_a_leg_that_swings_askew_has_another_heading(k, off_deg, found):
    """About half a turn is seen only where an axis points to the left by itself, as those of shanks do."""
    sensors = upside(worn())
    swing = [None, None, *(Swing(1.0 + 0.1 * n, n >= 2) for n in range(6))]
    sound = fields_unlike_others(*zip(*sensors, strict=True), swing)
    assert sound == ()
    swing[k] = Swing(swing[k].axis_rad + np.radians(off_deg), swing[k].points_left)
    assert [one.sensor for one in fields_unlike_others(*zip(*sensors, strict=True), swing)] == [
        f"s{k}"
    ] * found


def test_most_of_them_cannot_be_strange():
    sensors = [(changed(one, one.magnetic_field * (1.0 + k)), R) for k, (one, R) in enumerate(worn())]
    assert fields_unlike_others(*zip(*upside(sensors), strict=True), [None] * 8) == ()


def test_the_middle_of_fields_is_one_of_them():
    fields = np.array([[1.0, 0, 0], [1.1, 0, 0], [9.0, 0, 0]])
    np.testing.assert_array_equal(most_central(fields), fields[1])
    assert np.isnan(world_field(np.full((3, 3), np.nan), np.tile(np.eye(3), (3, 1, 1)))).all()
