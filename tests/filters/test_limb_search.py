"""A limb in doubt: which pose or names are far likelier, and when there are none."""

import numpy as np
import pytest

from mbkf.filters.limb_search import LimbSearch, Look, agrees
from mbkf.sensors.limb_fit import LimbFits
from mbkf.sensors.limb_starts import opposite_markers, turned_over
from tests.motions import moderate_pose, protocol_sensor, reference_model

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
FITS = LimbFits(SENSOR, np.full(36, 0.005), np.zeros(MODEL.nv, dtype=bool))
LEG = next(one for one in FITS.limbs if one.name == "left_thigh")
SEARCH = LimbSearch(FITS, 0.01)


@pytest.fixture
def right():
    return moderate_pose(MODEL, np.random.default_rng(3), spread=0.1)


def look(number, q, seen):
    return Look(number, q, seen)


def test_a_thigh_turned_over_is_found_and_its_velocity(right):
    step = np.zeros(MODEL.nv)
    step[LEG.dofs[0]] = 0.04
    later = MODEL.integrate(right, step)
    wrong = [turned_over(MODEL, q, *LEG.joints[:2]) for q in (later, right)]
    looks = [look(4, wrong[0], SENSOR.positions(later)), look(0, wrong[1], SENSOR.positions(right))]
    found = SEARCH.found(LEG, None, looks)
    assert found.order is None
    assert np.abs(MODEL.difference(later, found.q)[LEG.dofs]).max() < 0.05
    expected = np.zeros(len(LEG.dofs))
    expected[0] = 1.0
    np.testing.assert_allclose(found.v, expected, atol=0.1)
    assert not agrees(MODEL, wrong[0], found) and agrees(MODEL, later, found)


def test_a_right_limb_is_left_alone(right):
    seen = SENSOR.positions(right) + np.random.default_rng(0).normal(size=(36, 3)) * 0.005
    assert SEARCH.found(LEG, None, [look(0, right, seen)]) is None


def test_a_limb_that_markers_lead_beyond_its_ranges_is_left_alone(right):
    step = np.zeros(MODEL.nv)
    step[MODEL.joints["left_shank"].v.start + 1] = -np.radians(35.0)
    beyond = MODEL.integrate(MODEL.neutral(), step)
    assert SEARCH.found(LEG, None, [look(0, beyond, SENSOR.positions(beyond))]) is None


@pytest.mark.parametrize("sudden", [True, False])
def test_names_of_both_sides_are_put_right(right, sudden):
    order = np.arange(36)
    legs = FITS.on_limb[FITS.limbs.index(LEG)]
    for a, b in opposite_markers(SENSOR).items():
        if legs[a]:
            order[a], order[b] = b, a
    seen = SENSOR.positions(right)[order]
    found = SEARCH.found(LEG, None, [look(0, right, seen)], sudden=sudden)
    np.testing.assert_array_equal(found.order, order)
    assert agrees(MODEL, right, found)


def test_a_mend_is_carried_back_only_where_markers_show_the_limb(right):
    wrong = turned_over(MODEL, right, *LEG.joints[:2])
    seen = SENSOR.positions(right)
    found = SEARCH.found(LEG, None, [look(1, wrong, seen)])
    earlier = SEARCH.carried(found, None, look(0, wrong, seen))
    assert agrees(MODEL, right, earlier)
    seen[FITS.on_limb[FITS.limbs.index(LEG)]] = np.nan
    assert SEARCH.carried(found, None, look(0, wrong, seen)) is None
