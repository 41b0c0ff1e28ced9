"""Standard deviations of angles, rates, torques and foot heights from a filter's covariance."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.model.clinical import ClinicalAngles
from tests.motions import random_model, smooth_motion

DT_S = 0.01


@pytest.fixture(scope="module")
def case():
    """Body, a state in motion with a random covariance, the covariance of its last velocity step, and the spread."""
    rng = np.random.default_rng(3)
    model = random_model(rng)
    source = smooth_motion(model, rng)
    A = 1e-3 * rng.normal(size=(2 * model.nv, 2 * model.nv))
    B = 0.01 * rng.normal(size=(model.nv, model.nv))
    state = KinematicState(source.q(0.4), source.v(0.4), A @ A.T)
    reader, nv = SpreadReader(model), model.nv
    torque = reader.torque_variance(state.q, B @ B.T, DT_S)
    variances = np.split(np.diag(state.P), 2)
    parts = partial(reader.parts, state.q, state.P[:nv, :nv])
    return model, state, B, Spread(reader, state.q, *variances, torque, parts)


def slopes(model, q, read):
    """(n, nv) derivative of a reading along the manifold, by central differences."""
    h = 1e-6
    ends = [[read(model.integrate(q, s * h * e)) for s in (-1, 1)] for e in np.eye(model.nv)]
    return np.array([(after - before) / (2 * h) for before, after in ends]).T


def test_dofs_are_the_diagonal(case):
    _, state, _, spread = case
    np.testing.assert_allclose(np.r_[spread.position, spread.velocity] ** 2, np.diag(state.P), rtol=1e-12)
    assert len(spread.angle) == len(spread.reader.clinical.names)


def test_angles_by_finite_differences(case):
    """Var θ = J P Jᵀ with J the derivative of the clinical angles."""
    model, state, _, spread = case
    clinical, P = ClinicalAngles(model), state.P[: model.nv, : model.nv]
    J = slopes(model, state.q, lambda q: clinical.angles(q[None])[0])
    np.testing.assert_allclose(spread.angle, np.sqrt(np.diag(J @ P @ J.T)), rtol=1e-7)


def test_the_roots_orientation_is_its_own_part_of_the_covariance(case):
    """The spread of the root's angles follows from it alone."""
    _, state, _, spread = case
    clinical = spread.reader.clinical
    root = spread.ball_covariance[0]
    np.testing.assert_array_equal(root, state.P[3:6, 3:6])
    E = clinical.rate_matrix(state.q)[clinical.root_angles][:, clinical.root_turns]
    expected = np.sqrt(np.diag(E @ root @ E.T))
    np.testing.assert_allclose(spread.angle[clinical.root_angles], expected, rtol=1e-10)


def test_rates_of_independent_dofs(case):
    """Var θ̇ = Σ E² sd_v²."""
    model, state, _, spread = case
    E = ClinicalAngles(model).rate_matrix(state.q)
    np.testing.assert_allclose(spread.rate**2, E**2 @ spread.velocity**2, rtol=1e-10)


def test_foot_heights_by_finite_differences(case):
    """Var z = J P Jᵀ with J the derivative of the ankles' heights."""
    model, state, _, spread = case
    P = state.P[: model.nv, : model.nv]
    ids = [model.joint(foot).joint_id for foot in ("right_foot", "left_foot")]
    J = slopes(model, state.q, lambda q: model.placements(q)[1][ids, 2])
    rise = spread.reader.rise_jacobian(state.q)
    np.testing.assert_allclose(rise, J, atol=1e-7 * np.abs(J).max())
    np.testing.assert_allclose(spread.foot_height, np.sqrt(np.diag(J @ P @ J.T)), rtol=1e-7)


def test_torques_are_the_velocity_difference_through_the_mass_matrix(case):
    """Var τ = M Cov(v_k − v_{k−1}) Mᵀ / Δt²: the same for samples drawn from it."""
    model, state, B, spread = case
    changes = (B @ np.random.default_rng(0).normal(size=(model.nv, 4000))) / DT_S
    tau = model.mass_matrix(state.q) @ changes
    np.testing.assert_allclose(spread.torque, tau.std(axis=1), rtol=0.05)


@pytest.fixture(scope="module")
def shifted(case):
    """Random roots of errors by the body, and the spread with them."""
    model, _, _, spread = case
    rng = np.random.default_rng(7)
    roots = BodyErrorRoots(*(rng.normal(size=(n, 5)) for n in (model.nv, model.nv, model.nv, 12)))
    return roots, replace(spread, body=roots)


def test_without_errors_by_the_body_offsets_are_zero(case):
    spread = case[-1]
    for name in ("position", "velocity", "torque", "angle", "rate", "wrench", "ball"):
        assert not getattr(spread, f"{name}_offset").any()


@pytest.mark.parametrize("name", ["position", "velocity", "torque", "angle", "rate"])
def test_totals_are_both_independent_parts(case, shifted, name):
    alone, (_, both) = getattr(case[-1], name), shifted
    total, offset = getattr(both, name), getattr(both, f"{name}_offset")
    np.testing.assert_allclose(total**2, alone**2 + offset**2, rtol=1e-12)
    assert (offset > 0.0).all()


def test_offsets_are_those_of_errors_drawn_from_the_roots(case, shifted):
    """Of dofs, and of angles and rates through the same linear map; zeros of angles differ among persons besides."""
    roots, both = shifted
    clinical = ClinicalAngles(case[0])
    E, zeros = clinical.rate_matrix(case[1].q), {"angle": clinical.zero_variance, "rate": 0.0}
    for name, root in (("position", roots.position), ("velocity", roots.velocity), ("torque", roots.torque)):
        np.testing.assert_allclose(getattr(both, f"{name}_offset") ** 2, np.diag(root @ root.T), rtol=1e-12)
    for name, root in (("angle", E @ roots.position), ("rate", E @ roots.velocity)):
        expected = np.diag(root @ root.T) + zeros[name]
        np.testing.assert_allclose(getattr(both, f"{name}_offset") ** 2, expected, rtol=1e-9)
    np.testing.assert_allclose(
        both.wrench_offset.ravel() ** 2, np.diag(roots.wrench @ roots.wrench.T), rtol=1e-12
    )


def test_the_offset_of_a_ball_is_in_its_covariance(case, shifted):
    roots, both = shifted
    np.testing.assert_allclose(both.ball_offset[0], roots.position[3:6] @ roots.position[3:6].T, rtol=1e-12)
    np.testing.assert_allclose(both.ball_covariance - both.ball_offset, case[-1].ball_covariance, atol=1e-12)
