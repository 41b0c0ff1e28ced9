"""Centre of pressure and offset of a plate against what was put in."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import (
    centre_of_pressure,
    find_tare,
    half_sample_mode,
    offset_remarks,
    remove_tare,
    require_finite,
)

RATE_HZ = 1000.0
coordinate = st.floats(-0.5, 0.5)


@given(
    point=st.tuples(coordinate, coordinate),
    tilt=st.floats(-0.4, 0.4),
    force=st.tuples(st.floats(-200, 200), st.floats(-200, 200), st.floats(300, 2000)),
    torque=st.floats(-20, 20),
)
def test_centre_of_pressure_is_where_the_force_acts_even_on_a_slope(point, tilt, force, torque):
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    along = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    origin = np.array([0.3, -1.0, 0.2])
    arm = point[0] * along + point[1] * np.array([0.0, 1.0, 0.0])
    F = np.array([force])
    M = np.cross(arm, F) + torque * normal
    found = centre_of_pressure(F, M, origin, normal, 20.0)
    np.testing.assert_allclose(found, [origin + arm], atol=1e-9)


def test_no_centre_of_pressure_below_the_threshold():
    F = np.array([[0.0, 0.0, 19.9], [0.0, 0.0, 20.0], [0.0, 0.0, -500.0]])
    found = centre_of_pressure(F, np.zeros((3, 3)), np.zeros(3), np.array([0.0, 0.0, 1.0]), 20.0)
    np.testing.assert_array_equal(np.isnan(found).all(axis=1), [True, False, True])


def steps(offset: np.ndarray, noise_n: float, load: float = 700.0, seed: int = 0) -> np.ndarray:
    """(S, 6) readings of three steps on a plate with an offset, 3 s."""
    rng = np.random.default_rng(seed)
    t = np.arange(3000) / RATE_HZ
    pressed = np.clip(np.sin(2 * np.pi * t), 0.0, None) ** 0.5
    wrench = pressed[:, None] * np.array([50.0, -30.0, load, 40.0, -60.0, 5.0])
    return wrench + offset + rng.normal(0.0, noise_n, (3000, 6))


@pytest.mark.parametrize("vertical", [-32.0, -16.0, 0.0, 8.0, 35.0])
@pytest.mark.parametrize("noise_n", [0.0, 0.5, 2.0])
def test_offset_between_steps_is_found(vertical, noise_n):
    offset = np.array([3.0, -11.0, vertical, 4.0, -5.0, 1.0])
    tare = find_tare(steps(offset, noise_n), RATE_HZ)
    assert tare.found
    np.testing.assert_allclose(tare.offset, offset, atol=0.02 + 0.3 * noise_n)


def test_a_plate_without_load_becomes_zero():
    wrench = np.random.default_rng(3).normal([4, 11, -32, 5, 4, -1], 0.4, (3000, 6))
    tared = remove_tare(wrench, find_tare(wrench, RATE_HZ))
    np.testing.assert_allclose(tared.mean(axis=0), 0.0, atol=0.05)


def test_a_plate_with_a_person_on_it_throughout_keeps_its_load():
    wrench = np.random.default_rng(4).normal([1, 2, 592, 3, 4, 0], 0.7, (3000, 6))
    tare = find_tare(wrench, RATE_HZ)
    assert not tare.found
    np.testing.assert_array_equal(remove_tare(wrench, tare), wrench)


def test_two_feet_that_never_leave_their_plate_keep_their_load():
    t = np.arange(3000) / RATE_HZ
    wrench = np.zeros((3000, 6))
    wrench[:, 2] = 350.0 + 250.0 * np.sin(2 * np.pi * t)
    assert not find_tare(wrench, RATE_HZ).found


def test_readings_zeroed_by_software_stay_zero():
    wrench = steps(np.zeros(6), 0.0)
    loaded = wrench[:, 2] > 0
    np.testing.assert_array_equal(find_tare(wrench, RATE_HZ).offset, 0.0)
    shifted = np.where(loaded[:, None], wrench, [0, 0, -16.0, 0, 0, 0])
    shifted[:20] = 0.0
    tared = remove_tare(shifted, find_tare(shifted, RATE_HZ))
    np.testing.assert_array_equal(tared[:20], 0.0)
    assert find_tare(shifted, RATE_HZ).offset[2] == pytest.approx(-16.0)


def test_mode_is_where_the_sample_is_densest():
    rng = np.random.default_rng(5)
    sample = np.concatenate([rng.normal(-16.0, 0.1, 300), rng.uniform(-200.0, 50.0, 100)])
    assert half_sample_mode(sample) == pytest.approx(-16.0, abs=0.3)
    assert half_sample_mode(np.array([4.0])) == 4.0


def test_readings_that_are_no_numbers_are_located():
    force, moment = np.zeros((100, 3)), np.zeros((100, 3))
    require_finite(force, moment, 100.0, 2.0, "plate 1")
    moment[30, 1] = np.nan
    force[50, 0] = np.inf
    with pytest.raises(InvalidInput, match=r"plate 1: 2 of 100 samples .* first at 2\.300 s"):
        require_finite(force, moment, 100.0, 2.0, "plate 1")


def test_offsets_that_were_removed_are_told():
    zero = np.zeros((3, 3))
    plates = [
        PlateReadings(name, 100.0, 0.0, np.zeros(3), zero, zero, zero, 20.0, offset=offset)
        for name, offset in (("1", np.zeros(6)), ("2", np.array([0.0, 0.0, -12.34, 0.0, 0.0, 0.0])))
    ]
    assert offset_remarks(plates) == ["set '2': offset of -12.3 N vertical force removed"]
