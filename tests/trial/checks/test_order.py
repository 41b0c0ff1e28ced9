"""Two plates that are taken for each other are found where feet share the load; right ones are left alone."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.trial.checks.order import in_place_of, order_finding
from tests.checked import evidence, plates


def exchanged(one, other):
    return in_place_of(one, other), in_place_of(other, one)


def read_by(motion, read):
    """The evidence with other readings of the plates."""
    raw = plate_wrenches(read, motion.times_s, motion.rate_hz)
    return replace(motion, plates=read, given=motion.averaged(raw), raw=raw)


def test_plates_of_a_squat_in_each_others_place_are_found_and_put_right():
    """One plate bears a tenth more, the other a tenth less, and the motion is that of these loads."""
    right = plates("squat")
    given = evidence("squat")
    uneven = tuple(
        replace(one, force_n=k * one.force_n, moment_nm=k * one.moment_nm)
        for one, k in zip(right, (1.1, 0.9), strict=True)
    )
    motion = replace(given, asked=given.gives(uneven).sum(axis=1))
    assert order_finding(read_by(motion, uneven))[0] is None
    found, back = order_finding(read_by(motion, exchanged(*uneven)))
    assert found is not None and found.verdict == "outside"
    assert found.value > 1e6  # in each other's place they are the loads of the motion
    assert found.name == "order of plates '1' and '2'"
    for one, again in zip(uneven, back, strict=True):
        np.testing.assert_array_equal(again.force_n, one.force_n)
        np.testing.assert_allclose(again.moment_nm, one.moment_nm)
        np.testing.assert_allclose(again.origin_m, one.origin_m)


@pytest.mark.parametrize("motion", ["squat", "walk"])
def test_right_plates_keep_their_order(motion):
    assert order_finding(evidence(motion)) == (None, plates(motion))


def test_a_plate_in_anothers_place_keeps_name_and_presses_as_far_from_its_origin():
    one, other = plates("squat")
    found = in_place_of(one, other)
    assert found.name == one.name and found.corners_m is one.corners_m
    np.testing.assert_allclose(
        found.centre_of_pressure_m - found.origin_m, other.centre_of_pressure_m - other.origin_m, atol=1e-12
    )
