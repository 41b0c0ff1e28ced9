"""What a person can make a plate read: published peaks are possible, what lies beyond is not, in any unit of mass."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.sensors.contact.possible import (
    ANYWHERE_M,
    BEYOND_M,
    Fault,
    all_possible,
    impossible,
    reaches,
    without_impossible,
)
from tests.captures import made_plates

WEIGHT_N, REACH_M = 700.0, 0.8
share = st.floats(-1.0, 1.0)


def fault(fx=0.0, fy=0.0, fz=0.0, mx=0.0, my=0.0, mz=0.0, scale=1.0):
    """The fault of one reading, in body weights and body weights times metres."""
    wrench = scale * WEIGHT_N * np.array([fx, fy, fz, mx, my, mz])
    return Fault(int(impossible(wrench, scale * WEIGHT_N, REACH_M)))


@pytest.mark.parametrize(
    "reading",
    [
        {},
        {"fz": 1.2, "fx": 0.25, "fy": 0.1, "mx": 0.3, "my": 0.2, "mz": 0.02},
        {"fz": 15.2, "fx": -6.0},
        {"fz": 0.05, "fx": 0.3},
        {"fz": -0.2},
    ],
    ids=["nothing", "walk", "triple jump", "touch-down", "ringing"],
)
def test_what_was_measured_is_possible(reading):
    assert fault(**reading) == Fault.NONE


@pytest.mark.parametrize(
    ("reading", "kind"),
    [
        ({"fz": 21.0}, Fault.FORCE),
        ({"fz": -21.0}, Fault.FORCE),
        ({"fz": -0.5}, Fault.PULL),
        ({"fz": 1.0, "fy": 4.5}, Fault.SHEAR),
        ({"fz": 1.0, "my": 1.5}, Fault.MOMENT),
        ({"fz": 1.0, "mz": -4.0}, Fault.MOMENT),
        ({"fz": np.nan}, Fault.NOT_A_NUMBER),
        ({"fz": 1.0, "mz": np.inf}, Fault.NOT_A_NUMBER),
    ],
)
def test_each_limit_has_its_name(reading, kind):
    assert fault(**reading) == kind


@given(st.lists(share, min_size=6, max_size=6), st.sampled_from([0.25, 0.5, 2.0, 8.0]))
def test_limits_scale_with_the_mass(values, scale):
    reading = dict(zip(("fx", "fy", "fz", "mx", "my", "mz"), np.multiply(values, 30.0), strict=True))
    assert fault(**reading) == fault(**reading, scale=scale)


@given(st.lists(share, min_size=12, max_size=12), st.floats(0.0, 1.0))
def test_between_two_possible_readings_all_are_possible(values, along):
    """Else a gap that is bridged would be refused anew."""
    one, other = WEIGHT_N * np.reshape(values, (2, 6)) * [4.0, 4.0, 18.0, 4.0, 4.0, 8.0]
    slightly = WEIGHT_N * (1.0 + 1e-9)
    if not impossible(np.array([one, other]), WEIGHT_N, REACH_M).any():
        assert not impossible(one + along * (other - one), slightly, REACH_M)


def test_a_foot_presses_no_farther_than_beside_the_plate():
    plate = made_plates(1)[0]
    half_diagonal = float(np.hypot(0.2, 0.08))
    bare = replace(plate, corners_m=None)
    np.testing.assert_allclose(reaches([plate, bare]), [half_diagonal + BEYOND_M, ANYWHERE_M], rtol=1e-12)


def test_each_plate_has_its_own_reach():
    wrench = np.tile(WEIGHT_N * np.array([0.0, 0.0, 1.0, 5.0, 0.0, 0.0]), (3, 2, 1))
    found = impossible(wrench, WEIGHT_N, np.array([0.8, 20.0]))
    assert found.tolist() == [[Fault.MOMENT, Fault.NONE]] * 3


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("worst", [0.0, 0.5, 1.0, 2.0, 5.0, 25.0, np.nan, np.inf])
def test_readings_are_all_possible_where_none_is_impossible(worst):
    """Each component in turn grows until it cannot be; plates have reaches of their own."""
    reach_m, judged = np.array([0.8, 3.0]), set()
    for seed in range(40):
        rng = np.random.default_rng(seed)
        wrench = WEIGHT_N * np.tile([0.1, 0.1, 1.0, 0.1, 0.1, 0.05], (4, 2, 1))
        wrench[tuple(rng.integers((4, 2, 6)))] = worst * WEIGHT_N * rng.choice([-1.0, 1.0])
        expected = not impossible(wrench, WEIGHT_N, reach_m).any()
        assert all_possible(wrench, WEIGHT_N, reach_m) is expected
        judged.add(expected)
    assert judged == ({True} if worst == 0.0 else {True, False} if worst <= 5.0 else {False})


def test_a_frame_is_judged_about_each_plates_own_origin():
    """However far from the world's origin the plates lie."""
    far = np.array([80.0, -50.0, 0.3])
    plates = [replace(p, origin_m=p.origin_m + far, corners_m=p.corners_m + far) for p in made_plates(1)]
    force = WEIGHT_N * np.array([0.1, 0.0, 1.0])
    wrench = np.array([[*force, *np.cross(plate.origin_m, force)] for plate in plates])
    np.testing.assert_array_equal(without_impossible(wrench, plates, WEIGHT_N), wrench)
    wrench[1, 3:] = 0.0
    found = without_impossible(wrench, plates, WEIGHT_N)
    np.testing.assert_array_equal(found[0], wrench[0])
    assert np.isnan(found[1]).all()
    assert without_impossible(np.zeros((0, 6)), (), WEIGHT_N).shape == (0, 6)
