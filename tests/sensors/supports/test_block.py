"""The wrench of other contacts as a state: nothing while they are closed, what is expected of it while they bear."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.model.layout import ROOT_RESIDUAL, SUPPORT
from mbkf.sensors.block import Frame, Notes
from mbkf.sensors.supports.block import BEARING, Supports, SupportSettings
from tests.dynamics import DT, about, prepared_at, random_covariance, singer, standing
from tests.followed import made_filter, recording
from tests.motions import reference_model
from tests.supported import part

MODEL = reference_model()
NOWHERE = np.zeros(MODEL.nv, dtype=bool)
SEAT, RIGHT, LEFT, KNEE = (part(MODEL, name) for name in ("pelvis", "right_hand", "left_hand", "right_knee"))
LOAD = np.array([10.0, -20.0, 450.0, 30.0, -200.0, 15.0])
"""A wrench of a seat."""


@cache
def scene(**changes):
    """The block, bound; a state on a seat; where the parts are."""
    block = Supports(MODEL, DT, SupportSettings(**changes))
    plant = singer(MODEL, block.states())
    block.bind(plant.layout, plant.model)
    rng = np.random.default_rng(0)
    P = np.zeros((plant.layout.size, plant.layout.size))
    n = plant.layout[SUPPORT].start
    P[:n, :n] = random_covariance(MODEL, rng)[:n, :n]
    P[n:, n:] = 4.0 * np.eye(6)
    still = np.zeros(MODEL.nv)
    state = DynamicState(standing(MODEL), still, still, np.zeros(12), P, LOAD)
    return block, plant, state, block.bearings.at(state.q, still).points_m


def frame(*parts, flags=None):
    """A frame whose readings say that these parts bear."""
    flags = np.zeros(8) if flags is None else flags
    flags[list(parts)] = 1.0
    return Frame(np.zeros((0, 3)), np.zeros((0, 6)), None, {BEARING: flags})


def decided(*parts, memory=(), **changes):
    block, _, state, _ = scene(**changes)
    return block.decide(prepared_at(block, state), frame(*parts), memory, Notes())


def spreads(decision, **changes):
    """(6,) standard deviations that rows about the decision's own point state, and the rest of the rows."""
    block, _, state, _ = scene(**changes)
    rows = block.linearise(prepared_at(block, state), decision)
    own = rows.jacobian @ about(-decision.about_m)
    assert rows.first == block._slice.start
    np.testing.assert_allclose(rows.innovation, -rows.jacobian @ state.extra, rtol=1e-12)
    np.testing.assert_allclose(own, np.diag(np.diag(own)), atol=1e-12)
    return 1.0 / np.diag(own)


def test_nothing_bears_where_nothing_says_so():
    block, _, state, _ = scene()
    for read in (frame(), Frame(np.zeros((0, 3)), np.zeros((0, 6))), frame(flags=np.full(8, np.nan))):
        notes = Notes()
        decision = block.decide(prepared_at(block, state), read, (), notes)
        assert (decision.parts, decision.fresh, notes.supports) == ((), False, ())
        np.testing.assert_array_equal(decision.about_m, state.q[:3])


def test_what_flags_name_bears_and_is_noted_and_remembered():
    block, _, state, points = scene()
    notes, at = Notes(), prepared_at(block, state)
    flags = np.full(8, np.nan)
    decision = block.decide(at, frame(SEAT, LEFT, flags=flags), (), notes)
    assert decision.parts == notes.supports == (SEAT, LEFT)
    assert decision.fresh
    np.testing.assert_allclose(decision.about_m, points[[SEAT, LEFT]].mean(axis=0), atol=1e-12)
    memory = block.remember(state, at, decision, ())
    assert memory == (SEAT, LEFT)
    assert not block.decide(at, frame(SEAT), memory, Notes()).fresh
    assert block.begin() == ()


def test_closed_contacts_read_a_wrench_of_zero_about_the_pelvis():
    s = SupportSettings()
    np.testing.assert_allclose(
        spreads(decided()), np.repeat([s.closed_force_n, s.closed_moment_nm], 3), rtol=1e-9
    )


def test_a_seat_bears_freely_within_its_area_and_hardly_any_shear():
    s, size = SupportSettings(), np.linalg.norm(LOAD[:3])
    lever = scene()[0].bearings.levers_m[SEAT]
    expected = [*[s.support_shear_share * size] * 2, s.support_force_n, *[lever * size] * 3]
    np.testing.assert_allclose(spreads(decided(SEAT)), expected, rtol=1e-9)


def test_hands_may_pull_anywhere():
    block, s = scene()[0], SupportSettings()
    found = spreads(decided(RIGHT))
    np.testing.assert_allclose(found[:3], s.support_force_n, rtol=1e-9)
    assert spreads(decided(RIGHT, SEAT))[0] < s.support_force_n
    assert found[3] == pytest.approx(block.bearings.levers_m[RIGHT] * np.linalg.norm(LOAD[:3]))


def test_parts_that_are_apart_have_the_lever_of_their_distance():
    """Mean of squared distances from the middle, and of each one's own lever."""
    block, _, _, points = scene()
    both = [RIGHT, LEFT]
    apart = points[both] - points[both].mean(axis=0)
    lever = np.sqrt(np.mean((apart**2).sum(axis=1) + block.bearings.levers_m[both] ** 2))
    np.testing.assert_allclose(spreads(decided(*both))[3:], lever * np.linalg.norm(LOAD[:3]), rtol=1e-9)
    np.testing.assert_allclose(
        spreads(decided(*both, support_lever_scale=2.0), support_lever_scale=2.0)[3:],
        2.0 * spreads(decided(*both))[3:],
        rtol=1e-9,
    )


def test_a_load_that_is_still_small_is_read_as_a_tenth_of_the_weight():
    """Else a contact that begins could not grow."""
    block, _, state, _ = scene()
    rows = block.linearise(prepared_at(block, replace(state, extra=np.zeros(6))), decided(SEAT))
    moment = 1.0 / np.diag(rows.jacobian @ about(-decided(SEAT).about_m))[3:]
    lever, weight_n = block.bearings.levers_m[SEAT], GRAVITY_M_S2 * MODEL.mass_kg
    np.testing.assert_allclose(moment, 0.1 * lever * weight_n, rtol=1e-6)


def added(decision):
    """(6, 6) what inflation adds to the wrench's covariance, about the decision's point; nothing else changes."""
    block, plant, state, _ = scene()
    P, own = state.P.copy(), plant.layout[SUPPORT]
    block.inflate(P, decision)
    change = P - state.P
    X = about(decision.about_m)
    found = X @ change[own, own] @ X.T
    change[own, own] = 0.0
    assert not change.any()
    return found


def test_a_contact_begins_and_ends_wide_and_walks_on_between():
    s, off = SupportSettings(), 1e-6
    jump = np.repeat([s.support_force_n, 0.1 * s.support_force_n], 3) ** 2
    walk = np.repeat([s.support_force, s.support_moment], 3) ** 2 * DT
    np.testing.assert_allclose(added(decided(SEAT)), np.diag(jump), atol=off * jump.max())
    np.testing.assert_allclose(added(decided(SEAT, memory=(SEAT,))), np.diag(walk), atol=off * walk.max())
    np.testing.assert_allclose(added(decided(SEAT, memory=(KNEE,))), np.diag(walk), atol=off * walk.max())
    np.testing.assert_allclose(added(decided(memory=(SEAT,))), np.diag(jump), atol=off * jump.max())
    np.testing.assert_array_equal(added(decided()), 0.0)


def test_a_filter_that_asks_for_contacts_that_never_come_is_the_plain_one():
    """All but the last digits: the closed wrench is 0, and so are the wrenches that are told."""
    runs = []
    for asks in (False, True):
        one = made_filter("dynamic", other_contacts=asks)
        found = [one.start(recording(), 0, None)]
        for t in range(1, 15):
            found.append(one.step(found[-1], recording(), t))
        assert one.kalman.layout.extra_index(ROOT_RESIDUAL) == slice(0, 6)
        runs.append((one, found))
    (plain, before), (asking, after) = runs
    for one, two in zip(before, after, strict=True):
        residual, support = np.split(two.record.state.extra, [6])
        np.testing.assert_allclose(residual, one.record.state.extra, atol=1e-3)
        np.testing.assert_allclose(support, 0.0, atol=1e-3)
        for name, scale in (("q", 1e-6), ("v", 1e-5), ("a", 1e-3), ("wrench", 1e-4)):
            np.testing.assert_allclose(getattr(two, name), getattr(one, name), rtol=0, atol=scale)
        assert one.support is None
        np.testing.assert_array_equal(two.support, 0.0)
    np.testing.assert_allclose(asking.spread(after[-1]).torque, plain.spread(before[-1]).torque, rtol=1e-3)
    np.testing.assert_array_equal(asking.support_sd(after[-1]), 0.0)
