"""A plate's reading shared between two feet: what must hold wherever they stand and whatever the plate reads."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.sensors.contact.sharing import (
    ACROSS_SD_M,
    ALONG_SD_M,
    FORWARD,
    LEAST_APART_M,
    LEAST_RISE_M,
    MIDDLE,
    PUSH_SHARE,
    ROLL,
    STEP_M,
    expected_stance,
    push_apart,
    push_share,
    share_load,
    shear_to_pelvis,
    step_apart,
)
from tests.dynamics import about
from tests.motions import assert_near

RIGHT, LEFT = 0, 1
LENGTH_M, WIDTH_M, WEIGHT_N = 0.25, 0.2, 700.0
PELVIS = np.array([0.1, 0.0, 0.95])
small = st.floats(-0.3, 0.3)


def soles(ahead_m=0.0, width_m=WIDTH_M, surface_m=0.0):
    """Both soles along x, the right one so far ahead."""
    heel = np.array([[ahead_m, -0.5 * width_m, surface_m], [0.0, 0.5 * width_m, surface_m]])
    along = LENGTH_M * np.array([1.0, 0.0, 0.0])
    return np.stack([heel, heel + 0.7 * along, heel + along], axis=1)


def load(point, force=(0.0, 0.0, WEIGHT_N), free_nm=0.0):
    """A wrench about the world's origin that acts at a point."""
    return np.concatenate([force, np.cross(point, force) + np.array([0.0, 0.0, free_nm])])


def shared(total, feet, pelvis=PELVIS, surface_m=0.0):
    return share_load(np.asarray(total, dtype=float), feet.tolist(), pelvis, surface_m)


anything = st.tuples(small, small, st.floats(30.0, 2000.0), st.floats(-200, 200), st.floats(-200, 200), small)


@given(anything, small)
def test_the_feet_carry_what_the_plate_reads_and_neither_pulls(reading, ahead):
    x, y, fz, fx, fy, free = reading
    total = load([x, y, 0.0], [fx, fy, fz], 30 * free)
    found = shared(total, soles(ahead))
    np.testing.assert_allclose(found.wrench.sum(axis=0), total, rtol=1e-9, atol=1e-8)
    assert (found.wrench[:, 2] >= 0.0).all() and (found.wrench[:, 2] <= fz * (1 + 1e-12)).all()
    assert (found.sd > 0.0).all() and np.isfinite(found.sd).all()


@given(anything, small, small, small, st.floats(-3.1, 3.1), st.floats(-0.2, 0.5))
def test_it_does_not_matter_where_the_laboratory_has_its_origin(reading, ahead, east, north, turn, up):
    """Moved, turned about the vertical and raised: wrenches and centres follow, spreads turn or stay."""
    x, y, fz, fx, fy, _ = reading
    feet, total = soles(ahead), load([x, y, 0.0], [fx, fy, fz], 5.0)
    c, s = np.cos(turn), np.sin(turn)
    R, shift = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([3 * east, 3 * north, up])
    turned = np.concatenate([R @ total[:3], R @ total[3:] + np.cross(shift, R @ total[:3])])
    here, there = shared(total, feet), shared(turned, feet @ R.T + shift, R @ PELVIS + shift, up)
    # A foot that carries nothing but rounding ε takes √ε of a shear of up to 283 N: 4e-6 N.
    assert_near(there.wrench[:, :3], here.wrench[:, :3] @ R.T, 1e-5)
    moments = here.wrench[:, 3:] @ R.T + np.cross(shift, there.wrench[:, :3])
    np.testing.assert_allclose(there.wrench[:, 3:], moments, atol=1e-5)
    np.testing.assert_allclose(there.centres_m, here.centres_m @ R.T + shift, atol=1e-9)
    np.testing.assert_allclose(there.sd, here.sd, rtol=1e-9)


@given(anything, small, st.floats(0.0, 0.4))
def test_swapped_feet_have_swapped_wrenches(reading, ahead, width):
    x, y, fz, fx, fy, free = reading
    total = load([x, y, 0.0], [fx, fy, fz], 30 * free)
    one, other = shared(total, soles(ahead, width)), shared(total, soles(ahead, width)[::-1])
    np.testing.assert_allclose(other.wrench, one.wrench[::-1], rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(other.centres_m, one.centres_m[::-1], atol=1e-12)


@pytest.mark.parametrize("ahead", [-0.6, -0.1, 0.0, 0.2, 0.5])
@pytest.mark.parametrize("foot", [RIGHT, LEFT])
def test_a_load_at_one_foots_centre_is_all_its_own(ahead, foot):
    feet = soles(ahead)
    centres = expected_stance(feet.tolist(), 0.0).centres_m
    found = shared(load(centres[foot]), feet)
    assert found.wrench[foot, 2] == pytest.approx(WEIGHT_N)
    assert_near(found.wrench[1 - foot] / WEIGHT_N, np.zeros(6), 1e-8)
    assert_near(found.centres_m[foot], centres[foot], 1e-12)


def test_side_by_side_both_carry_half_in_the_middle():
    feet = soles()
    middle = feet[:, 0] + MIDDLE * (feet[:, 2] - feet[:, 0])
    found = shared(load(middle.mean(axis=0)), feet, np.array([*middle.mean(axis=0)[:2], 0.95]))
    assert_near(found.centres_m, middle, 1e-12)
    assert_near(found.wrench[:, 2], np.full(2, 0.5 * WEIGHT_N), 1e-9)
    assert_near(found.wrench[:, 0], np.zeros(2), 1e-9)
    assert found.wrench[RIGHT, 1] == pytest.approx(-found.wrench[LEFT, 1])
    assert found.wrench[RIGHT, 1] > 0  # the legs lean outwards and press the feet apart


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_the_share_is_where_the_pressure_lies_between_the_centres(share):
    feet = soles(0.5)
    right, left = expected_stance(feet.tolist(), 0.0).centres_m
    found = shared(load(share * right + (1 - share) * left), feet)
    assert found.wrench[RIGHT, 2] == pytest.approx(share * WEIGHT_N)


def test_the_centres_roll_forward_while_the_load_passes_over():
    """From the heel and the ball of heel strike to those of toe-off; the pressure of the sum stays between them."""
    feet = soles(0.5)  # the right foot is ahead
    ahead, behind = expected_stance(feet.tolist(), 0.0).centres_m
    strike, off = (shared(load(p), feet).centres_m for p in (behind, ahead))
    assert_near(strike[LEFT], behind, 1e-12)
    assert_near(off[RIGHT], ahead, 1e-12)
    assert_near(off - strike, np.tile([ROLL * LENGTH_M, 0.0, 0.0], (2, 1)), 1e-12)
    for share in (0.2, 0.5, 0.9):
        found = shared(load(share * ahead + (1 - share) * behind), feet).centres_m
        assert_near(found - strike, np.tile([share * ROLL * LENGTH_M, 0.0, 0.0], (2, 1)), 1e-12)


@given(anything, small)
def test_the_pressure_lies_between_the_centres_in_the_ratio_of_the_forces(reading, ahead):
    x, y, fz, *_ = reading
    total = load([x, y, 0.0], [0.0, 0.0, fz])
    found = shared(total, soles(ahead))
    assert_near(found.wrench[:, 2] / fz @ found.centres_m, np.array([x, y, 0.0]), 1e-9)
    for foot in (RIGHT, LEFT):  # only a moment about the vertical is left about its centre
        assert_near((about(found.centres_m[foot]) @ found.wrench[foot])[3:5], np.zeros(2), 1e-7)


def test_feet_nearer_than_a_step_are_loaded_in_proportion():
    shift = [
        expected_stance(soles(ahead).tolist(), 0.0).centres_m[RIGHT, 0] - ahead for ahead in (0.0, 0.1, 1.0)
    ]
    assert shift[0] == pytest.approx(MIDDLE * LENGTH_M)
    assert shift[0] - shift[1] == pytest.approx(FORWARD * LENGTH_M * 0.1 / STEP_M)
    assert shift[0] - shift[2] == pytest.approx(FORWARD * LENGTH_M)


@pytest.mark.parametrize(("width", "apart"), [(0.1, 0.1), (0.3, 0.3), (0.01, LEAST_APART_M)])
def test_side_by_side_the_spread_is_that_across_the_feet(width, apart):
    feet = soles(0.0, width)
    middle = expected_stance(feet.tolist(), 0.0).centres_m.mean(axis=0)
    assert shared(load(middle), feet).sd[2] == pytest.approx(0.5**0.5 * ACROSS_SD_M / apart * WEIGHT_N)


def test_one_behind_the_other_the_spread_is_that_along_the_feet():
    feet = soles(0.6, 0.0)
    right, left = expected_stance(feet.tolist(), 0.0).centres_m
    for share in (0.0, 0.3, 1.0):
        found = shared(load(share * right + (1 - share) * left), feet)
        expected = np.hypot(share, 1 - share) * ALONG_SD_M / (right - left)[0]
        assert found.sd[2] == pytest.approx(expected * WEIGHT_N)


def test_the_spread_is_that_of_pressures_beside_the_expected_centres():
    """Feet pressed elsewhere by independent spreads: the share is wrong by what is stated, to first order."""
    rng, feet, share = np.random.default_rng(0), soles(0.25), 0.4
    centres = expected_stance(feet.tolist(), 0.0).centres_m
    off = np.zeros((4000, 2, 3))
    off[:, :, 0] = ALONG_SD_M * rng.normal(size=(4000, 2))
    off[:, :, 1] = ACROSS_SD_M * rng.normal(size=(4000, 2))
    pressed = np.array([share, 1 - share]) @ (centres + off)
    found = [shared(load(p), feet) for p in pressed]
    wrong = np.array([one.wrench[RIGHT, 2] for one in found]) - share * WEIGHT_N
    stated = np.sqrt(np.mean([one.sd[2] ** 2 for one in found]))
    assert np.sqrt((wrong**2).mean()) == pytest.approx(stated, rel=0.05)


def test_feet_on_one_spot_still_have_finite_shares():
    feet = soles(0.0, 0.0)
    found = shared(load([0.1, 0.02, 0.0]), feet)
    assert np.isfinite(found.wrench).all() and np.isfinite(found.sd).all()
    assert_near(found.wrench.sum(axis=0), load([0.1, 0.02, 0.0]), 1e-9)
    assert_near(found.wrench[:, 2], np.full(2, 0.5 * WEIGHT_N), 1e-9)


def test_a_foot_that_pushes_off_bears_less_the_higher_its_ball():
    def share(rise_m, heel_m=0.15, stood_s=0.5):
        sole = [[0.0, 0.0, heel_m], [0.2, 0.0, rise_m], [0.25, 0.0, 0.0]]
        return push_share(sole, 0.0, stood_s)

    shares = [share(rise) for rise in (0.0, 0.01, 0.02, 0.05)]
    assert shares == sorted(shares, reverse=True)
    assert shares[0] == PUSH_SHARE and shares[-1] < 0.02
    assert share(0.0, heel_m=0.03) is None, "a flat foot does not push off"
    assert share(0.0, stood_s=0.05) is None, "a foot that has just landed does not either"


def test_forces_point_to_the_pelvis_and_are_bounded_where_that_is_near_the_floor():
    centres = np.array([[0.2, -0.1, 0.0], [-0.3, 0.1, 0.0]])
    pelvis = np.array([0.1, 0.0, 0.9])
    forces = np.column_stack([shear_to_pelvis(pelvis, centres), np.ones(2)])
    np.testing.assert_allclose(np.cross(forces, pelvis - centres), 0.0, atol=1e-12)
    low = np.array([0.1, 0.0, LEAST_RISE_M])
    np.testing.assert_array_equal(
        shear_to_pelvis(centres[0], centres), shear_to_pelvis(centres[0] + [0.0, 0.0, LEAST_RISE_M], centres)
    )
    np.testing.assert_allclose(shear_to_pelvis(low, centres), (low - centres)[:, :2] / LEAST_RISE_M)


@given(
    st.floats(-0.6, 0.6), st.floats(0.1, 0.5), st.floats(50.0, 900.0), st.floats(50.0, 900.0), small, small
)
def test_feet_that_push_apart_leave_the_sum_of_their_wrenches(ahead, width, right_n, left_n, x, y):
    """It is the part of forces to the pelvis that acts along the line between both centres of pressure."""
    pelvis, vertical = np.array([x, y, 0.9]), np.array([right_n, left_n])
    stance = expected_stance(soles(ahead, width).tolist(), 0.0)
    found = push_apart(stance, pelvis, vertical)
    np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-9)
    centres = stance.centres_at(right_n / (right_n + left_n))
    np.testing.assert_allclose(found[:, 3:], np.cross(centres, found[:, :3]), atol=1e-9)
    line = (centres[RIGHT] - centres[LEFT])[:2]
    to_pelvis = shear_to_pelvis(pelvis, centres) * vertical[:, None]
    assert found[RIGHT, 2] == 0.0
    np.testing.assert_allclose(np.cross(found[RIGHT, :3], [*line, 0.0]), 0.0, atol=1e-9)
    half = 0.5 * (to_pelvis[RIGHT] - to_pelvis[LEFT]) @ line
    np.testing.assert_allclose(found[RIGHT, :2] @ line, half, rtol=1e-9, atol=1e-9)


def test_feet_on_one_point_push_nothing_apart():
    stance = expected_stance(soles(0.0, 0.0).tolist(), 0.0)
    assert not push_apart(stance, PELVIS, np.array([300.0, 300.0])).any()


@pytest.mark.parametrize(("ahead_m", "steps"), [(0.0, 0.0), (0.6, 1.0), (-0.6, 1.0)])
def test_feet_are_side_by_side_or_a_step_apart(ahead_m, steps):
    assert step_apart(expected_stance(soles(ahead_m).tolist(), 0.0)) == pytest.approx(steps, abs=1e-9)


def test_steps_grow_with_the_distance_ahead():
    steps = [step_apart(expected_stance(soles(ahead).tolist(), 0.0)) for ahead in (0.05, 0.1, 0.15)]
    assert 0.0 < steps[0] < steps[1] < steps[2] < 1.0
