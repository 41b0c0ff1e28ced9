"""Both sides of Newton's law from a true motion: they agree, and follow mass and plates."""

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from tests.checked import amplified, body, evidence, plates


def test_motion_asks_for_what_plates_give():
    found = evidence()
    clear = found.clear
    assert clear.sum() > 0.8 * len(clear)
    off = (found.asked - found.total)[clear]
    weight_n = GRAVITY_M_S2 * body().mass_kg
    assert found.weight_n == weight_n
    assert np.sqrt(np.mean(off[:, :3] ** 2)) < 0.02 * weight_n
    assert np.sqrt(np.mean(off[:, 3:] ** 2)) < 0.01 * weight_n


def test_what_is_asked_for_goes_with_the_mass():
    one, other = evidence(), evidence(mass=1.3)
    known = ~np.isnan(one.asked[:, 0])
    np.testing.assert_allclose(other.asked[known], 1.3 * one.asked[known], rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(one.given, other.given, atol=1e-9)


def test_what_is_given_goes_with_the_plates():
    found = evidence()
    np.testing.assert_allclose(found.gives(plates()), found.given)
    twice = found.gives(amplified(plates(), [2.0] * len(plates())))
    np.testing.assert_allclose(twice, 2.0 * found.given, atol=1e-9)


def test_one_plate_can_be_exchanged():
    found, (changed,) = evidence(), amplified(plates()[:1], [2.0])
    other = found.with_plate(0, changed, 2.0 * found.raw[:, 0])
    np.testing.assert_allclose(other.given, found.gives(other.plates), atol=1e-9)
    np.testing.assert_array_equal(other.raw[:, 1:], found.raw[:, 1:])
    np.testing.assert_allclose(other.given[:, 0], 2.0 * found.given[:, 0], atol=1e-9)
    np.testing.assert_array_equal(other.given[:, 1:], found.given[:, 1:])
    np.testing.assert_array_equal(other.accounted, found.accounted)


def test_averages_that_reach_into_other_frames_are_not_clear():
    found = evidence()
    left_out = np.zeros(len(found.times_s), dtype=bool)
    left_out[100] = True
    assert not found.without(left_out).clear[95:106].any()
    assert found.without(left_out).clear[90] == found.clear[90]
    only = found.restricted(left_out)
    assert only.accounted.sum() == 1 and not only.clear.any()


def test_without_plates_nothing_is_accounted_for():
    assert not evidence(read=()).accounted.any()
