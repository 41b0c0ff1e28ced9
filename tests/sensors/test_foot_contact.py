"""The feet's twelve rows: minus the derivative of their innovations, about the soles, by what each foot stands on."""

from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.model.layout import Layout
from mbkf.sensors.block import OperatingPoint
from mbkf.sensors.contact.records import Contact, ContactDecision, ContactMemory, FreeStance
from mbkf.sensors.contact.sharing import LEVER_M, STEP_M, SharedLoad, Stance
from mbkf.sensors.foot_contact import BELT_FORCE, PUSH_LEAST, FootContact, FootContactSettings, FootDecision

FIRST, WEIGHT_N, DT = 6, 700.0, 0.01
SETTINGS = FootContactSettings()
BLOCK = FootContact(None, WEIGHT_N, DT, SETTINGS)
BLOCK.bind(Layout.of(2, q=2, v=2, a=2, wrench=12), None)
MEMORY = ContactMemory((), (), float("nan"), (0.0, 0.0))
SINGLE = (Contact.UNMEASURED, Contact.AIR, Contact.MEASURED)
PAIRS = [*product(SINGLE, repeat=2), (Contact.SHARED, Contact.SHARED)]


def load(contacts, seed=0):
    rng = np.random.default_rng(seed)
    wrench = rng.normal(0.0, 100.0, (2, 6))
    wrench[:, 2] = 300.0
    wrench[[foot in (Contact.AIR, Contact.UNMEASURED) for foot in contacts]] = 0.0
    centres = rng.uniform(-0.5, 0.5, (2, 3))
    if Contact.SHARED not in contacts:
        return ContactDecision(contacts, wrench, centres, False, MEMORY)
    shared = SharedLoad(wrench, rng.uniform(-0.5, 0.5, (2, 3)), rng.uniform(10.0, 50.0, 6))
    return ContactDecision(contacts, np.tile(wrench.sum(axis=0), (2, 1)), centres, False, MEMORY, shared)


def filled(loaded, w, lifted=()):
    at = OperatingPoint(SimpleNamespace(w=w), None)
    rows, values, first, plates, _ = BLOCK.linearise(at, FootDecision(loaded, lifted))
    assert rows.shape == (12, 12) and first == FIRST
    return rows, values, plates


def about(centre_m, wrench):
    """The same wrench about another point."""
    return np.concatenate([wrench[:3], wrench[3:] - np.cross(centre_m, wrench[:3])])


@pytest.mark.parametrize("contacts", PAIRS)
def test_rows_are_minus_the_derivative_of_the_innovations(contacts):
    loaded, w = load(contacts), np.tile([10.0, -5.0, 200.0, 3.0, 2.0, 1.0], 2)
    rows, values, plates = filled(loaded, w)
    assert plates == 6 * sum(foot == Contact.MEASURED for foot in contacts) or Contact.SHARED in contacts
    step = np.random.default_rng(1).normal(size=12)
    moved = filled(loaded, w + step)[1]
    np.testing.assert_allclose(moved - values, -rows @ step, rtol=1e-9, atol=1e-9)


def test_a_plate_reads_the_wrench_about_the_sole_with_its_own_noise():
    loaded, w = load((Contact.AIR, Contact.MEASURED)), np.arange(12.0)
    _, values, plates = filled(loaded, w)
    assert plates == 6
    noise = np.repeat([SETTINGS.plate_force_n, SETTINGS.plate_moment_nm], 3)
    off = about(loaded.centres_m[1], loaded.wrench[1] - w[6:])
    np.testing.assert_allclose(values[:6], off / noise, rtol=1e-12)


def test_a_shared_plate_reads_the_sum():
    loaded, w = load((Contact.SHARED, Contact.SHARED)), np.arange(12.0)
    _, values, plates = filled(loaded, w)
    assert plates == 6
    noise = np.repeat([SETTINGS.plate_force_n, SETTINGS.plate_moment_nm], 3)
    off = about(loaded.centres_m.mean(axis=0), loaded.wrench[0] - w[:6] - w[6:])
    np.testing.assert_allclose(values[:6], off / noise, rtol=1e-9)


def test_the_right_foot_reads_its_share_with_the_spread_of_that():
    loaded, w = load((Contact.SHARED, Contact.SHARED)), np.arange(12.0)
    rows, values, _ = filled(loaded, w)
    share = loaded.shared
    off = about(share.centres_m[0], share.wrench[0] - w[:6])
    np.testing.assert_allclose(values[6:], off / share.sd, rtol=1e-9)
    assert not rows[6:, 6:].any()


def test_shares_leave_what_the_plate_says_of_the_sum_alone():
    """Whatever the share: the sum is known as exactly as by the plate, the difference only by the share."""
    loaded = load((Contact.SHARED, Contact.SHARED))
    rows, values, _ = filled(loaded, np.zeros(12))
    P = np.linalg.inv(rows.T @ rows)
    to_middle = np.array([about(loaded.centres_m.mean(axis=0), one) for one in np.eye(6)]).T
    to_centre = np.array([about(loaded.shared.centres_m[0], one) for one in np.eye(6)]).T
    both = to_middle @ np.hstack([np.eye(6), np.eye(6)])
    right = to_centre @ np.hstack([np.eye(6), np.zeros((6, 6))])
    noise = np.repeat([SETTINGS.plate_force_n, SETTINGS.plate_moment_nm], 3)
    np.testing.assert_allclose(both @ P @ both.T, np.diag(noise**2), atol=1e-6)
    np.testing.assert_allclose(right @ P @ right.T, np.diag(loaded.shared.sd**2), rtol=1e-6, atol=1e-6)
    found = P @ rows.T @ values
    np.testing.assert_allclose(found, loaded.shared.wrench.ravel(), rtol=1e-6, atol=1e-6)


def test_a_free_foot_carries_what_the_plates_do_not_under_its_sole():
    loaded = load((Contact.MEASURED, Contact.UNMEASURED))
    rest = WEIGHT_N - loaded.wrench[0, 2]
    w = np.concatenate([loaded.wrench[0], np.zeros(6)])
    w[8] = rest
    w[9:] = np.cross(loaded.centres_m[1], [0.0, 0.0, rest])
    np.testing.assert_allclose(filled(loaded, w)[1], 0.0, atol=1e-9)


@pytest.mark.parametrize("lifted", [(), (0,)])
def test_a_free_foot_that_pulls_carries_nothing(lifted):
    loaded, w = load((Contact.UNMEASURED, Contact.AIR)), np.zeros(12)
    w[2] = -50.0 if not lifted else 20.0
    rows, values, _ = filled(loaded, w, lifted)
    assert values[2] == pytest.approx(-w[2] / SETTINGS.pulling_force_n)
    assert rows[2, 2] == pytest.approx(1.0 / SETTINGS.pulling_force_n)


BESIDE, STEPPED = SETTINGS.free_direction


def both_free(share_right, ahead_m=0.4):
    """Both feet on floor without a plate, the right one ahead, and wrenches that press where expected.

    They point to the pelvis by the share that belongs to the distance.
    """
    centres = np.array([[0.1 + ahead_m, -0.1, 0.0], [0.1, 0.1, 0.0]])
    stance = Stance(centres, np.zeros((2, 3)), np.array([1.0, 0.0]))
    pelvis = np.array([0.3, 0.0, 1.0])
    kinds = (Contact.UNMEASURED, Contact.UNMEASURED)
    loaded = ContactDecision(
        kinds, np.zeros((2, 6)), stance.centres_m, False, MEMORY, free=FreeStance(stance, pelvis)
    )
    vertical = WEIGHT_N * np.array([share_right, 1.0 - share_right])
    arms = pelvis - stance.centres_m
    forces = arms / arms[:, 2:] * vertical[:, None]
    forces[:, :2] *= BESIDE + min(ahead_m / STEP_M, 1.0) * (STEPPED - BESIDE)
    return loaded, np.concatenate([forces, np.cross(stance.centres_m, forces)], axis=1).ravel()


@pytest.mark.parametrize("ahead_m", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("share_right", [0.2, 0.5, 0.9])
def test_feet_in_double_support_press_where_they_stand_towards_the_pelvis(share_right, ahead_m):
    loaded, w = both_free(share_right, ahead_m)
    _, values, plates = filled(loaded, w)
    assert plates == 0
    vertical = np.zeros(12, dtype=bool)
    vertical[[2, 8]] = True
    np.testing.assert_allclose(values[~vertical], 0.0, atol=1e-9)
    expected = (0.5 * WEIGHT_N - w[[2, 8]]) / (SETTINGS.free_force_share * WEIGHT_N)
    np.testing.assert_allclose(values[vertical], expected, rtol=1e-9)


@pytest.mark.parametrize(("ahead_m", "loose"), [(0.0, 1.0), (0.15, 0.5), (0.4, 0.0)])
def test_feet_side_by_side_may_lean_together_but_not_against_each_other(ahead_m, loose):
    """Spread of the centres of pressure along the soles: of the feet together, and of one against the other."""
    loaded, w = both_free(0.5, ahead_m)
    rows, values, _ = filled(loaded, w)
    force = 0.5 * WEIGHT_N

    def over_sd(right_m, left_m):
        moved = w.copy()
        moved[[4, 10]] -= force * np.array([right_m, left_m])
        return np.linalg.norm((filled(loaded, moved)[1] - values)[[4, 10]])

    together = LEVER_M + loose * SETTINGS.free_sway_m
    assert over_sd(0.1, 0.1) == pytest.approx(2.0**0.5 * 0.1 / together)
    assert over_sd(0.1, -0.1) == pytest.approx(2.0**0.5 * 0.1 / LEVER_M)
    step = np.random.default_rng(1).normal(size=12)
    np.testing.assert_allclose(filled(loaded, w + 1e-6 * step)[1] - values, -1e-6 * rows @ step, atol=1e-10)


@pytest.mark.parametrize("height_m", [0.0, -0.5])
def test_a_pelvis_no_higher_than_the_soles_leaves_finite_rows(height_m):
    """As of a track so far away that numbers no longer resolve the body."""
    loaded, w = both_free(0.5)
    free = loaded.free
    for pelvis in (free.stance.centres_m[0], np.array([0.3, 0.0, 0.0])):
        low = free._replace(pelvis_m=pelvis + np.array([0.0, 0.0, height_m]))
        rows, values, _ = filled(replace(loaded, free=low), w)
        assert np.isfinite(rows).all() and np.isfinite(values).all()


def test_a_foot_that_pushes_off_tells_its_share():
    """Read as zero where the share is right, whatever the load; weakly, as the setting says."""
    loaded, w = both_free(0.3)
    free = loaded.free._replace(push_share=(0.3, None))
    rows, values, _ = filled(replace(loaded, free=free), w)
    assert values[2] == pytest.approx(0.0, abs=1e-9)
    assert filled(replace(loaded, free=free), 1.5 * w)[1][2] == pytest.approx(0.0, abs=1e-9)
    more = w.copy()
    more[2] += 50.0
    sd = SETTINGS.free_push_share * (0.3 + PUSH_LEAST) * WEIGHT_N
    assert filled(replace(loaded, free=free), more)[1][2] == pytest.approx(-50.0 * 0.7 / sd)
    np.testing.assert_array_equal(np.flatnonzero(rows[2]), [2, 8])


def test_their_sum_decides_how_they_share():
    """With the sum of both wrenches known, the levers tell the share, and its spread is that of the levers."""
    loaded, w = both_free(0.3)
    rows, _, _ = filled(loaded, w)
    exact = np.hstack([np.eye(6), np.eye(6)]) / 0.1
    P = np.linalg.inv(rows.T @ rows + exact.T @ exact)
    assert 0.02 * WEIGHT_N < np.sqrt(P[2, 2]) < 0.1 * WEIGHT_N


def test_a_foot_about_to_land_where_no_plate_reads_may_carry_a_little():
    loaded, w = load((Contact.AIR, Contact.MEASURED)), np.zeros(12)
    sure, _, _ = filled(loaded, w)
    soft, _, _ = filled(replace(loaded, near=(0.5, 0.0)), w)
    spread = SETTINGS.air_force_n + 0.5 * SETTINGS.landing_force_n
    assert 1.0 / sure[8, 2] == pytest.approx(SETTINGS.air_force_n)
    assert 1.0 / soft[8, 2] == pytest.approx(spread)
    np.testing.assert_array_equal(sure[:6], soft[:6])


def test_wrenches_wander_about_the_soles():
    loaded = load((Contact.UNMEASURED, Contact.UNMEASURED))
    sd = np.repeat([SETTINGS.wrench_force, SETTINGS.wrench_moment], 3) * DT**0.5
    P = np.zeros((FIRST + 12, FIRST + 12))
    BLOCK.inflate(P, FootDecision(loaded))
    assert not P[:FIRST].any() and not P[FIRST : FIRST + 6, FIRST + 6 :].any()
    for centre, first in zip(loaded.centres_m, (FIRST, FIRST + 6), strict=True):
        wander = P[first : first + 6, first : first + 6]
        to_sole = np.array([about(centre, one) for one in np.eye(6)]).T
        np.testing.assert_allclose(to_sole @ wander @ to_sole.T, np.diag(sd**2), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("contacts", PAIRS[:-1])
@pytest.mark.parametrize("near, floor_m_s", [((0.0, 0.0), (0.0, 0.0)), ((0.3, 0.6), (-1.2, 0.4))])
@pytest.mark.parametrize("lifted", [(), (0,), (1,)])
def test_the_kernel_reads_and_inflates_as_is_stated(contacts, near, floor_m_s, lifted, reference_kernel):
    """To rounding, for feet that bear and pull in every way."""
    stated, rng = FootContact(BLOCK.detector, WEIGHT_N, DT, SETTINGS), np.random.default_rng(2)
    stated.bind(BLOCK.layout, None)
    decision = FootDecision(replace(load(contacts), near=near, floor_m_s=floor_m_s), lifted)
    at = OperatingPoint(SimpleNamespace(w=rng.normal(0.0, 200.0, 12)), None)
    found, expected = BLOCK.linearise(at, decision), stated.linearise(at, decision)
    assert found[2:] == expected[2:]
    for one, other in zip(found[:2], expected[:2], strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())
    P = rng.normal(size=(FIRST + 14, FIRST + 14))
    ours, theirs = P.copy(), P.copy()
    BLOCK.inflate(ours, decision)
    stated.inflate(theirs, decision)
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())


def test_a_belt_takes_the_place_of_the_force_along():
    """The moment of a vertical force changes across the belt's way, beyond the usual wandering."""
    still = load((Contact.UNMEASURED, Contact.AIR))
    P, moved = np.zeros((2, FIRST + 12, FIRST + 12))
    BLOCK.inflate(P, FootDecision(still))
    BLOCK.inflate(moved, FootDecision(replace(still, floor_m_s=(-3.0, 0.0))))
    more = (moved - P)[FIRST : FIRST + 6, FIRST : FIRST + 6]
    expected = np.zeros((6, 6))
    expected[4, 4] = (BELT_FORCE * WEIGHT_N * 3.0 * DT) ** 2
    np.testing.assert_allclose(more, expected, atol=1e-6)


def test_feet_that_pull_at_the_floor_are_read_anew():
    """Unmeasured ones only, and only where they pull by more than they are kept from that."""
    decision = FootDecision(load((Contact.UNMEASURED, Contact.MEASURED)))
    w = np.zeros(12)
    w[[2, 8]] = -3.1 * SETTINGS.pulling_force_n
    assert BLOCK.review(SimpleNamespace(w=w), decision).lifted == (0,)
    w[2] = -2.9 * SETTINGS.pulling_force_n
    assert BLOCK.review(SimpleNamespace(w=w), decision) is None
    assert BLOCK.review(SimpleNamespace(w=w - 1e3), FootDecision(load((Contact.AIR, Contact.AIR)))) is None


@pytest.mark.parametrize("contacts", PAIRS)
def test_the_noise_is_that_of_the_plates_that_are_read(contacts):
    sd = np.repeat([SETTINGS.plate_force_n, SETTINGS.plate_moment_nm], 3)
    plates = 1 if Contact.SHARED in contacts else contacts.count(Contact.MEASURED)
    expected = plates * 2.0 * np.log(sd).sum()
    assert BLOCK.log_noise(FootDecision(load(contacts))) == pytest.approx(expected)
