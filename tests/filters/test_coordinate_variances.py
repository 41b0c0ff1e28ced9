"""Variances of clinical coordinates are those by the whole rates' matrix, by the kernel and without it."""

import numpy as np
import pytest

from mbkf.filters.coordinate_variances import CoordinateVariances
from mbkf.model.clinical import ClinicalAngles
from tests.motions import moderate_pose, random_model


def case(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    return rng, model, ClinicalAngles(model)


def read(clinical, q, covariances):
    reader = CoordinateVariances(clinical)
    at = reader.dofs
    blocks = [P[at[:, :, None], at[:, None, :]] for P in covariances]
    return reader.of(q, blocks, [np.diag(P) for P in covariances])


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("turned", [False, True])
def test_they_are_the_diagonal_of_the_whole(seed, turned):
    """E P Eᵀ, in any posture: the root has turned beyond half a turn, joints beyond a right angle."""
    rng, model, clinical = case(seed)
    q = moderate_pose(model, rng)
    if turned:
        q = model.integrate(q, 2.0 * rng.normal(size=model.nv))
    roots = rng.normal(size=(3, model.nv, model.nv))
    E, found = clinical.rate_matrix(q), read(clinical, q, [A @ A.T for A in roots])
    for A, variance in zip(roots, found, strict=True):
        np.testing.assert_allclose(variance, np.square(E @ A).sum(axis=1), rtol=1e-9)


@pytest.mark.usefixtures("either_kernel")
def test_at_a_singularity_they_are_very_large_and_finite():
    """Both other angles of the joint; all that moves another joint stays what it is."""
    _, model, clinical = case(0)
    where, q = clinical.rate_layout, model.neutral()
    ball, axis = 5, where.order[5, 1]
    step = np.zeros(model.nv)
    step[where.dofs[ball, axis]] = 0.5 * np.pi
    there = model.integrate(q, step)
    plain, found = (read(clinical, at, [np.eye(model.nv)])[0] for at in (q, there))
    assert np.isfinite(found).all()
    large = np.isin(np.arange(len(found)), where.columns[ball, [0, 2]])
    assert (found[large] > 1e12).all()
    np.testing.assert_allclose(found[~large], plain[~large], rtol=1e-9)
