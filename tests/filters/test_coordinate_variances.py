"""Standard deviations of clinical coordinates are those by the whole rates' matrix, by the kernel and without it."""

import numpy as np
import pytest

from mbkf.filters.coordinate_variances import CoordinateVariances, DofVariances
from mbkf.model.clinical import ClinicalAngles
from tests.motions import moderate_pose, random_model


def case(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    return rng, model, ClinicalAngles(model)


def of(clinical, P, V):
    """Parts of covariances of configuration and velocity."""
    at = CoordinateVariances(clinical).dofs
    blocks = (one[at[:, :, None], at[:, None, :]] for one in (P, V))
    return DofVariances(np.diag(P).copy(), np.diag(V).copy(), *blocks)


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("turned", [False, True])
def test_they_are_the_diagonal_of_the_whole(seed, turned):
    """E P Eᵀ, in any posture: the root has turned beyond half a turn, joints beyond a right angle."""
    rng, model, clinical = case(seed)
    q = moderate_pose(model, rng)
    if turned:
        q = model.integrate(q, 2.0 * rng.normal(size=model.nv))
    own, position, velocity = rng.normal(size=(3, model.nv, model.nv))
    rates = np.square(rng.normal(size=model.nv))
    E, zero = clinical.rate_matrix(q), clinical.zero_variance
    reader = CoordinateVariances(clinical)
    filters = of(clinical, own @ own.T, np.diag(rates))._replace(velocity_blocks=None)
    alone = np.array([np.square(E @ own).sum(axis=1), np.square(E) @ rates])
    offset = np.array([np.square(E @ position).sum(axis=1) + zero, np.square(E @ velocity).sum(axis=1)])
    found = reader.deviations(q, filters, of(clinical, position @ position.T, velocity @ velocity.T))
    np.testing.assert_allclose(found**2, [*(alone + offset), *offset], rtol=1e-9)
    without = reader.deviations(q, filters, None)
    np.testing.assert_allclose(without**2, [*alone, *np.zeros(alone.shape)], rtol=1e-9)


@pytest.mark.usefixtures("either_kernel")
def test_a_variance_that_rounding_leaves_below_zero_is_zero():
    _, model, clinical = case(0)
    below = -1e-20 * np.eye(model.nv)
    one = of(clinical, below, below)
    found = CoordinateVariances(clinical).deviations(model.neutral(), one._replace(velocity_blocks=None), one)
    np.testing.assert_array_equal(found[2] ** 2 > 0.0, clinical.zero_variance > 0.0)
    assert np.isfinite(found).all() and not found[3].any()


@pytest.mark.usefixtures("either_kernel")
def test_a_variance_that_is_not_known_stays_unknown():
    _, model, clinical = case(0)
    one = of(clinical, np.eye(model.nv), np.full((model.nv, model.nv), np.nan))
    found = CoordinateVariances(clinical).deviations(
        model.neutral(), one._replace(velocity_blocks=None), None
    )
    assert np.isfinite(found[0]).all() and np.isnan(found[1]).all()


@pytest.mark.usefixtures("either_kernel")
def test_at_a_singularity_they_are_very_large_and_finite():
    """Both other angles of the joint; all that moves another joint stays what it is."""
    _, model, clinical = case(0)
    where, q = clinical.rate_layout, model.neutral()
    ball, axis = 5, where.order[5, 1]
    step = np.zeros(model.nv)
    step[where.dofs[ball, axis]] = 0.5 * np.pi
    there = model.integrate(q, step)
    one = of(clinical, np.eye(model.nv), np.eye(model.nv))._replace(velocity_blocks=None)
    plain, found = (CoordinateVariances(clinical).deviations(at, one, None)[0] ** 2 for at in (q, there))
    assert np.isfinite(found).all()
    large = np.isin(np.arange(len(found)), where.columns[ball, [0, 2]])
    assert (found[large] > 1e12).all()
    np.testing.assert_allclose(found[~large], plain[~large], rtol=1e-9)
