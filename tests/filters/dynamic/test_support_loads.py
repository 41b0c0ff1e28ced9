"""What parts besides the feet carry, and the torques that makes: against the body's own inverse dynamics."""

from functools import cache

import numpy as np
import pytest

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.support_loads import SupportLoads
from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.model.layout import SUPPORT
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import NO_DOFS
from mbkf.sensors.supports.block import Supports
from mbkf.sensors.supports.sharing import shares
from tests.dynamics import DT, random_state, singer
from tests.motions import reference_model
from tests.supported import part

MODEL = reference_model()
NV = MODEL.nv
WHOLE = np.array([15.0, -10.0, 500.0, 40.0, -60.0, 8.0])
SEAT, RIGHT, LEFT, KNEE = (part(MODEL, name) for name in ("pelvis", "right_hand", "left_hand", "right_knee"))
SOME = [(SEAT,), (RIGHT,), (RIGHT, LEFT), (SEAT, RIGHT, LEFT), (RIGHT, LEFT, KNEE)]


@cache
def scene():
    """A reader of loads, and a state with a wrench on all parts besides the feet, as uncertain as the rest."""
    block = Supports(MODEL, DT)
    layout = singer(MODEL, block.states()).layout
    rng = np.random.default_rng(1)
    s = random_state(MODEL, rng)
    size = layout.size
    A = rng.normal(size=(size, size))
    return SupportLoads(MODEL, layout), layout, DynamicState(s.q, s.v, s.a, s.w, A @ A.T / size, WHOLE)


def made(parts):
    """The loads, torques with derivatives and variance by the sharing."""
    reader, _, s = scene()
    balance = NewtonEuler(MODEL)
    torque, loads = balance.torques(s.q, s.v, s.a, s.w), reader.of(parts, s)
    by_state, shared = reader.torques(balance, torque, loads)
    return torque, loads, by_state, shared


def under(q, parts, wrench):
    """(6 n, nv) Jacobians J at the world's origin of the parts' segments, and (nv,) Jᵀ w of wrenches on them."""
    segments = [scene()[0].bearings.parts[k].segment for k in parts]
    J = np.vstack([MODEL.segment_jacobian(q, segment, np.zeros(3)) for segment in segments])
    return J, J.T @ wrench.ravel()


@pytest.mark.parametrize("parts", SOME)
def test_torques_are_inverse_dynamics_less_every_load(parts):
    torque, loads, _, _ = made(parts)
    s = scene()[2]
    feet = sum(
        MODEL.segment_jacobian(s.q, segment, np.zeros(3)).T @ wrench
        for segment, wrench in zip(MODEL.roles.feet, s.w.reshape(2, 6), strict=True)
    )
    expected = MODEL.inverse_dynamics(s.q, s.v, s.a) - feet - under(s.q, parts, loads.shares.wrench)[1]
    np.testing.assert_allclose(torque.tau, expected, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("parts", SOME)
def test_the_root_feels_the_whole_wherever_it_acts(parts):
    torque, _, _, _ = made(parts)
    s = scene()[2]
    wrenches = s.w.copy()
    wrenches[:6] += WHOLE
    residual = NewtonEuler(MODEL).root(s.q, s.v, s.a, wrenches).residual
    np.testing.assert_allclose(torque.tau[:6], residual, atol=1e-8 * np.abs(torque.tau).max())


@pytest.mark.parametrize("parts", SOME)
def test_the_spread_by_sharing_is_that_of_its_covariance_and_leaves_the_root_alone(parts):
    _, loads, _, shared = made(parts)
    J, _ = under(scene()[2].q, parts, loads.shares.wrench)
    expected = np.diag(J.T @ loads.shares.covariance @ J)
    np.testing.assert_allclose(shared, expected, atol=1e-8 * max(expected.max(), 1.0))
    assert np.abs(shared[:6]).max() < 1e-6 * (WHOLE @ WHOLE)
    bears = loads.shares.wrench.any(axis=1).sum()
    assert (bears > 1) == (len(parts) > 1)
    assert (shared.max() > 1.0) == (bears > 1)


def test_loads_come_from_the_state():
    reader, _, s = scene()
    points = reader.bearings.at(s.q, s.v).points_m
    found = reader.of((SEAT, LEFT), s)
    expected = shares(WHOLE, points[[SEAT, LEFT]], reader.bearings.levers_m[[SEAT, LEFT]], [False, True])
    np.testing.assert_allclose(found.shares.wrench, expected.wrench, atol=1e-12)
    told = reader.wrench(found)
    np.testing.assert_array_equal(told[[SEAT, LEFT]], found.shares.wrench)
    np.testing.assert_array_equal(np.delete(told, [SEAT, LEFT], axis=0), 0.0)
    np.testing.assert_allclose(told.sum(axis=0), WHOLE, atol=1e-9)


def errors(state):
    """Errors of the filter's own covariance alone."""
    return ErrorCovariance(scene()[1], state.P, np.eye(NV), NO_DOFS, 0.0, 1.0, 0.0)


def test_one_part_has_the_states_spread():
    reader, layout, s = scene()
    found = reader.sd(reader.of((SEAT,), s), errors(s))
    np.testing.assert_allclose(found[SEAT], np.sqrt(np.diag(s.P)[layout[SUPPORT]]), rtol=1e-6)
    np.testing.assert_array_equal(np.delete(found, SEAT, axis=0), 0.0)


def test_several_parts_have_the_spread_of_their_sharing_besides():
    """Diagonal of D P Dᵀ + C."""
    reader, layout, s = scene()
    loads = reader.of((RIGHT, LEFT), s)
    own = layout[SUPPORT]
    D, C = loads.shares.by_whole.reshape(12, 6), loads.shares.covariance
    expected = np.sqrt(np.diag(D @ s.P[own, own] @ D.T + C))
    np.testing.assert_allclose(reader.sd(loads, errors(s))[[RIGHT, LEFT]].ravel(), expected, rtol=1e-9)


def test_where_only_feet_bear_nothing_is_added():
    reader, _, s = scene()
    torque, loads, by_state, shared = made(())
    plain = NewtonEuler(MODEL).torques(s.q, s.v, s.a, s.w)
    assert loads is None
    np.testing.assert_array_equal(torque.tau, plain.tau)
    np.testing.assert_array_equal(by_state, plain.by_state)
    assert shared is None
    np.testing.assert_array_equal(reader.wrench(None), np.zeros((8, 6)))
    np.testing.assert_array_equal(reader.sd(None, None), np.zeros((8, 6)))


def test_a_filter_without_the_state_tells_nothing():
    layout = singer(MODEL).layout
    reader = SupportLoads(MODEL, layout)
    assert reader.of((SEAT,), scene()[2]) is None
    assert reader.wrench(None) is None
