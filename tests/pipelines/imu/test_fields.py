"""Fields compared: a magnetometer that is turned, weak or in iron is named, whichever it is, and no other."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.imu.readings import ImuReadings
from mbkf.pipelines.imu.fields import most_central, strange_fields, world_field

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
    (found,) = strange_fields(*zip(*sensors, strict=True))
    assert found.sensor == f"s{k}" and f"s{k}" in found.told
    if how == "weak":
        assert found.size == pytest.approx(0.3, abs=0.06)


def test_good_ones_are_not_accused_and_two_do_not_judge():
    sensors = worn()
    assert strange_fields(*zip(*sensors, strict=True)) == ()
    one, R = sensors[0]
    assert strange_fields(*zip(*[(changed(one, 0.1 * one.magnetic_field), R), sensors[1]], strict=True)) == ()


def test_the_middle_of_fields_is_one_of_them():
    fields = np.array([[1.0, 0, 0], [1.1, 0, 0], [9.0, 0, 0]])
    np.testing.assert_array_equal(most_central(fields), fields[1])
    assert np.isnan(world_field(np.full((3, 3), np.nan), np.tile(np.eye(3), (3, 1, 1)))).all()
