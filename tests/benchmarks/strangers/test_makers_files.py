"""Files that the rows of strangers write are what their readers find, and errors are those of known turns."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.strangers import makers_files
from benchmarks.strangers.makers_files import _after_alignment, moving_sensor
from benchmarks.strangers.makers_recordings import cwa, mt_manager_ticks, x_imu
from mbkf.io.imu.files import read_imu


@pytest.fixture(scope="module")
def true():
    whole = makers_files.SECONDS
    makers_files.SECONDS = 6.0
    yield moving_sensor("a", 3)
    makers_files.SECONDS = whole


@pytest.mark.parametrize(
    ("write", "rate", "coarse"), [(mt_manager_ticks, 100.0, 1e-9), (cwa, 100.0, 0.03), (x_imu, 128.0, 0.5)]
)
def test_a_form_is_read_back_at_its_rate(true, tmp_path, write, rate, coarse):
    (one,) = read_imu(write(true, tmp_path))
    assert one.rate_hz == pytest.approx(rate, rel=1e-4)
    times = np.arange(one.samples) / rate
    for found, written in ((one.specific_force_mps2, true.force), (one.angular_velocity_rad_s, true.turning)):
        expected = np.column_stack([np.interp(times, true.time_s, written[:, axis]) for axis in range(3)])
        np.testing.assert_allclose(found, expected, atol=coarse)


def test_readings_belong_to_the_true_turn(true):
    """Before it moves, force and field stand where the true orientation has them."""
    up, north = (
        Rotation.from_quat(true.turn[:200]).apply(values[:200]).mean(axis=0)
        for values in (true.force, true.field)
    )
    np.testing.assert_allclose(up, [0.0, 0.0, 9.80665], atol=0.1)
    np.testing.assert_allclose(north, [0.0, 20.0, -40.0], atol=1.5)


def test_errors_are_those_that_no_turn_of_world_or_sensor_takes_away():
    rng = np.random.default_rng(0)
    reference = Rotation.random(200, random_state=1)
    noise = Rotation.from_rotvec(rng.normal(0.0, 0.02, (200, 3)))
    world, sensor = Rotation.from_rotvec([0.4, 0.1, 1.5]), Rotation.from_rotvec([-0.3, 0.9, 0.2])
    own = noise * world * reference * sensor
    assert _after_alignment(own.as_quat(), reference.as_quat()) == pytest.approx(0.02 * np.sqrt(3.0), rel=0.1)
