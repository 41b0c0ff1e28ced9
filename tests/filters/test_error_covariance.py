"""The stated covariance: what is new and what skin repeats, told apart by experiment."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.model.layout import Layout

NV = 5
EVERYBODY, LAYOUT = np.arange(NV), Layout.dynamic(NV)


def made(seed):
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(3 * NV + 12,) * 2), rng.normal(size=(2 * NV, NV))
    return rng, A @ A.T, B.T @ B


@given(st.integers(0, 200), st.floats(0.01, 1.0), st.floats(0.0, 20.0))
def test_it_is_symmetric_and_positive(seed, new, rate):
    rng, P, information = made(seed)
    seen = np.flatnonzero(rng.random(NV) > 0.3)
    stated = ErrorCovariance(LAYOUT, P, information, seen, 0.2, new, rate).covariance()
    np.testing.assert_allclose(stated, stated.T, rtol=1e-12, atol=1e-9 * np.abs(stated).max())
    assert np.linalg.eigvalsh(stated).min() > -1e-9 * np.abs(stated).max()


@given(st.integers(0, 200), st.floats(0.01, 1.0), st.floats(0.0, 20.0))
def test_parts_are_those_of_the_whole(seed, new, rate):
    """What is read off without the whole covariance is what the whole says."""
    rng, P, information = made(seed)
    errors = ErrorCovariance(LAYOUT, P, information, np.flatnonzero(rng.random(NV) > 0.3), 0.2, new, rate)
    free = [(), (0,), (1,), (0, 1)][seed % 4]
    errors = replace(
        errors,
        free=free,
        sharing=2.0,
        late=rng.normal(size=(2, NV + 12)),
        edges=rng.normal(size=(3, 12)),
        new_rates=(0.3 * new, 2.0 * new),
        plates=rng.uniform(0.1, 1.0, (2, 6)),
    )
    whole, T = errors.covariance(), rng.normal(size=(7, len(P)))
    near = {"rtol": 1e-9, "atol": 1e-9 * np.abs(whole).max()}
    np.testing.assert_allclose(errors.position, whole[:NV, :NV], **near)
    np.testing.assert_allclose(errors.position_variance, np.diag(whole)[:NV], **near)
    np.testing.assert_allclose(errors.velocity_variance, np.diag(whole)[NV : 2 * NV], **near)
    np.testing.assert_allclose(errors.variance_of(T), np.diag(T @ whole @ T.T), **near)
    np.testing.assert_allclose(errors.wrench_variance, np.diag(whole)[3 * NV :], **near)
    assert np.linalg.eigvalsh(whole).min() > -near["atol"]


def test_a_frame_that_says_nothing_of_a_joint_says_so():
    """Where nothing is known of a seen dof its information cannot be inverted: LinAlgError, nothing made up."""
    _, P, _ = made(4)
    with pytest.raises(np.linalg.LinAlgError):
        ErrorCovariance(LAYOUT, P, np.zeros((NV, NV)), EVERYBODY, 0.2, 0.04, 4.0).covariance()


def test_without_skin_it_is_the_share_that_is_new():
    _, P, information = made(1)
    stated = ErrorCovariance(LAYOUT, P, information, EVERYBODY, 0.0, 0.04, 4.0).covariance()
    np.testing.assert_allclose(stated[: 3 * NV, : 3 * NV], 0.04 * P[: 3 * NV, : 3 * NV])
    np.testing.assert_array_equal(stated[3 * NV :, 3 * NV :], P[3 * NV :, 3 * NV :])


def test_unknown_joints_keep_what_the_filter_says():
    _, P, information = made(2)
    unknown = np.array([1, 3])
    stated = ErrorCovariance(LAYOUT, P, information, np.array([0, 2, 4]), 0.3, 0.04, 4.0).covariance()
    for block in (0, NV, 2 * NV):
        own = np.ix_(block + unknown, block + unknown)
        np.testing.assert_array_equal(stated[own], P[own])


def test_skin_that_swings_has_the_stated_covariance():
    """Poses fitted to markers that swing as sines with random phases, by simulation; no other error."""
    rng, _, _ = made(3)
    H, rate, amplitude, runs = rng.normal(size=(12, NV)), 4.0, 0.1, 40_000
    fit = np.linalg.pinv(H)
    phase = rng.uniform(0, 2 * np.pi, (runs, 12))
    skin = np.sqrt(2.0) * amplitude * np.sin(phase)
    rates = np.sqrt(2.0) * amplitude * rate * np.cos(phase)
    x = np.hstack([skin @ fit.T, rates @ fit.T, -(rate**2) * skin @ fit.T])
    measured = x.T @ x / runs
    P = np.zeros((3 * NV + 12,) * 2)
    errors = ErrorCovariance(LAYOUT, P, H.T @ H, EVERYBODY, amplitude**2, 0.04, rate)
    stated = errors.covariance()[: 3 * NV, : 3 * NV]
    scale = np.sqrt(np.diag(stated))
    np.testing.assert_allclose(measured / scale / scale[:, None], stated / scale / scale[:, None], atol=0.03)


def test_reactions_without_a_plate_err_as_accelerations_do():
    _, P, information = made(3)
    stated = ErrorCovariance(LAYOUT, P, information, EVERYBODY, 0.0, 0.04, 4.0, free=(1,)).covariance()
    np.testing.assert_allclose(stated[3 * NV + 6 :, 3 * NV + 6 :], 0.04 * P[3 * NV + 6 :, 3 * NV + 6 :])
    np.testing.assert_array_equal(stated[3 * NV :, 3 * NV :][:6, :6], P[3 * NV :, 3 * NV :][:6, :6])
    other = ErrorCovariance(
        LAYOUT, P, information, EVERYBODY, 0.0, 0.04, 4.0, free=(1,), new_rates=(0.09, 0.02)
    ).covariance()
    np.testing.assert_allclose(other[2 * NV : 3 * NV, 3 * NV + 6 :], 0.02 * P[2 * NV : 3 * NV, 3 * NV + 6 :])
    np.testing.assert_allclose(other[3 * NV + 6 :, 3 * NV + 6 :], 0.02 * P[3 * NV + 6 :, 3 * NV + 6 :])


def test_how_two_feet_share_is_known_less_well_than_their_sum():
    """The spread of the difference is larger by the factor, that of the sum is none the worse."""
    _, P, information = made(5)
    usual, wider = (
        ErrorCovariance(LAYOUT, P, information, EVERYBODY, 0.0, 0.04, 4.0, (0, 1), sharing).covariance()
        for sharing in (1.0, 2.5)
    )
    both, apart = (np.hstack([np.zeros((6, 3 * NV)), np.eye(6), sign * np.eye(6)]) for sign in (1.0, -1.0))
    np.testing.assert_allclose(both @ wider @ both.T, both @ usual @ both.T, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(apart @ wider @ apart.T, 2.5**2 * (apart @ usual @ apart.T), rtol=1e-9)


def test_what_lags_errs_along_its_change():
    """A torque to which the late parts add up to nothing has no further spread."""
    rng, P, information = made(6)
    lag = rng.normal(size=NV + 12)
    usual = ErrorCovariance(LAYOUT, P, information, EVERYBODY, 0.2, 0.04, 4.0, (0,))
    late = replace(usual, late=lag[None])
    np.testing.assert_allclose(
        replace(usual, late=np.array([0.6 * lag, 0.8 * lag])).covariance(), late.covariance()
    )
    T = np.concatenate([np.zeros(2 * NV), lag])[None]
    across = rng.normal(size=NV + 12)
    U = np.concatenate([np.zeros(2 * NV), across - (across @ lag) / (lag @ lag) * lag])[None]
    np.testing.assert_allclose(late.variance_of(T) - usual.variance_of(T), (lag @ lag) ** 2, rtol=1e-9)
    np.testing.assert_allclose(late.variance_of(U), usual.variance_of(U), rtol=1e-9)
