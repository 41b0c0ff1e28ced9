"""Variances worked out together are those of the whole error covariance, by the kernel and without it."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.filters.state_variances import state_variances
from mbkf.model.layout import ExtraState, Layout

NV, DOFS = 31, np.array([[3, 4, 5], [6, 7, 8], [28, 29, 30], [0, 1, 2]])


def errors(seed, unseen=0.0):
    """Of a state with six components behind the feet's wrenches, for random settings."""
    rng = np.random.default_rng(seed)
    N = 3 * NV + 18
    A, B = rng.normal(size=(N, N)), rng.normal(size=(3 * NV, NV))
    free = [(), (0,), (0, 1)][seed % 3]
    support = ExtraState("support", *np.zeros((3, 6)))
    return rng, ErrorCovariance(
        Layout.dynamic(NV, [support]),
        A @ A.T,
        B.T @ B,
        np.flatnonzero(rng.random(NV) >= unseen),
        40.0,
        0.3,
        3.0,
        free,
        2.0,
        None if seed % 2 else rng.normal(size=(2, NV + 18)),
        rng.normal(size=(4, 12)),
        new_rates=(0.2, 0.4),
        plates=0.4,
    )


def assert_diagonals(errors, by_state, by_position):
    """All that is told, against the whole covariance Σ."""
    found = state_variances(errors, by_state, by_position, DOFS)
    whole, n = errors.covariance(), by_state.shape[1]
    own = whole[:NV, :NV]
    for variance, expected in (
        (found.position, np.diag(own)),
        (found.velocity, np.diag(whole)[NV : 2 * NV]),
        (found.wrench, np.diag(whole)[3 * NV : 3 * NV + 12]),
        (found.torque, np.diag(by_state @ whole[:n, :n] @ by_state.T)),
        (found.height, np.diag(by_position @ own @ by_position.T)),
        (found.blocks, own[DOFS[:, :, None], DOFS[:, None, :]]),
    ):
        np.testing.assert_allclose(variance, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("unseen", [0.0, 0.4])
def test_they_are_diagonals_of_the_whole_covariance(seed, unseen):
    rng, stated = errors(seed, unseen)
    for further in (12, 18):
        T = rng.normal(size=(NV, 3 * NV + further))
        T[:, rng.random(T.shape[1]) < 0.3] = 0.0
        assert_diagonals(stated, T, rng.normal(size=(2, NV)))


@pytest.mark.usefixtures("either_kernel")
def test_without_skin_and_information_they_are_the_filters_own():
    rng, stated = errors(1)
    plain = replace(stated, information=np.zeros((NV, NV)), seen=np.zeros(0, dtype=int), skin=0.0, free=())
    assert_diagonals(plain, rng.normal(size=(NV, 3 * NV + 12)), rng.normal(size=(2, NV)))


@pytest.mark.usefixtures("either_kernel")
def test_what_the_kernel_cannot_factorise_is_told_as_without_it():
    """An information that is positive but for rounding has an inverse within limits; one of zeros has none."""
    rng, stated = errors(2)
    T, U = rng.normal(size=(NV, 3 * NV + 12)), rng.normal(size=(2, NV))
    thin = rng.normal(size=(NV - 1, NV))
    assert_diagonals(replace(stated, information=thin.T @ thin - 1e-9 * np.eye(NV)), T, U)
    with pytest.raises(np.linalg.LinAlgError):
        state_variances(replace(stated, information=np.zeros((NV, NV))), T, U, DOFS)
