"""Prediction and update by the kernel are the textbook's; what it cannot factorise the reference does."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.kernel.covariance import (
    correction,
    informed_with_rows,
    positive_informed,
)
from mbkf.kernel.loading import library
from mbkf.numerics import information_update
from tests.dynamics import DT, singer
from tests.motions import random_model, reference_model, worst

needs_kernel = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")


def covariance(rng, size):
    """(size, size) exactly symmetric, over two decades and more."""
    root = rng.normal(size=(size, size + 3)) * 10 ** rng.uniform(-1, 1, (size, 1))
    P = root @ root.T
    return np.tril(P) + np.tril(P, -1).T


def information(rng, size, readings):
    H = rng.normal(size=(readings, size)) * 10 ** rng.uniform(-1, 1, (readings, 1))
    H[:, rng.random(size) < 0.2] = 0.0
    matrix = H.T @ H
    return np.tril(matrix) + np.tril(matrix, -1).T


def banded_rows(rng, readings, size):
    """Rows that are zero outside of a few columns, as those of plates, and full ones."""
    rows = rng.normal(size=(readings, size))
    for row in rows:
        first, last = np.sort(rng.integers(0, size + 1, 2))
        row[:first] = row[last:] = 0.0
    return rows


@pytest.mark.usefixtures("products")
@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 10**6),
    st.integers(1, 61),
    st.integers(0, 30),
    st.integers(0, 30),
    st.sampled_from("CF"),
    st.sampled_from([0.0, 0.4]),
)
def test_the_update_is_the_textbook_s(seed, n, further, readings, order, held):
    """Any sizes: those of tiles, less and more; components whose value is certain stay so."""
    rng = np.random.default_rng(seed)
    N = n + further
    P, matrix = np.array(covariance(rng, N), order=order), information(rng, n, n + 4)
    certain = rng.random(N) < held
    P[certain] = P[:, certain] = 0.0
    rows = banded_rows(rng, readings, N)
    kept = P.copy()
    found = informed_with_rows(P, matrix, rows)
    whole = rows.T @ rows
    whole[:n, :n] += matrix
    # P - P (I + L P)^-1 L P, which needs no inverse of P, in scaled components.
    scale = np.where(certain, 1.0, np.sqrt(np.diag(P)))
    C, L = P / scale / scale[:, None], whole * scale * scale[:, None]
    expected = (C - C @ np.linalg.solve(np.eye(N) + L @ C, L @ C)) * scale * scale[:, None]
    bound = 1e-9 * np.outer(scale, scale)
    assert (np.abs(found - expected) <= bound).all()
    assert not found[certain].any()
    np.testing.assert_array_equal(found, found.T)
    np.testing.assert_array_equal(P, kept)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 61), st.integers(0, 20), st.integers(0, 20))
def test_the_update_is_the_reference_s(seed, n, further, readings):
    rng = np.random.default_rng(seed)
    P, matrix = covariance(rng, n + further), information(rng, n, n + 4)
    rows = banded_rows(rng, readings, n + further)
    expected = information_update.informed_with_rows(P, matrix, rows)
    scale = np.sqrt(np.diag(P))
    assert (np.abs(informed_with_rows(P, matrix, rows) - expected) <= 1e-10 * np.outer(scale, scale)).all()


def test_information_without_a_factor_and_covariances_spoilt_by_rounding_are_the_reference_s(either_kernel):
    rng = np.random.default_rng(3)
    P, rows = covariance(rng, 9), banded_rows(rng, 4, 9)
    H = rng.normal(size=(2, 6))
    spoilt = P - 1.001 * np.linalg.eigvalsh(P)[0] * np.eye(9)
    for prior in (P, spoilt):
        found = informed_with_rows(prior, H.T @ H, rows)
        expected = information_update.informed_with_rows(prior, H.T @ H, rows)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * worst(P))


def test_a_covariance_that_must_not_be_mended_is_refused(either_kernel):
    rng = np.random.default_rng(3)
    P, rows = covariance(rng, 9), banded_rows(rng, 4, 9)
    matrix = information(rng, 6, 8)
    assert worst(positive_informed(P, matrix, rows) - informed_with_rows(P, matrix, rows)) < 1e-9 * worst(P)
    with pytest.raises(np.linalg.LinAlgError, match="not positive"):
        positive_informed(P - 2.0 * np.linalg.eigvalsh(P)[-1] * np.eye(9), matrix, rows)


@needs_kernel
@pytest.mark.parametrize("joints", [[[0, 3]], [[1, 2]], [[0, 1], [0, 2]], [[0, 1], [1, 1]], []])
def test_joints_that_do_not_have_all_dofs_once_are_refused(joints):
    ranges, one = np.array(joints, dtype=np.int32).reshape(-1, 2), np.eye(2)
    with pytest.raises(ValueError, match="joints must"):
        library().propagate_velocities(np.eye(4), one, one, ranges, 0.1, np.zeros((2, 2, 2)))


MODELS = {"reference": reference_model(), "random": random_model(np.random.default_rng(4))}


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
@pytest.mark.parametrize("order", ["C", "F"])
def test_the_prediction_is_phi_p_phi_and_noise(either_kernel, model, order):
    rng = np.random.default_rng(5)
    nv = model.nv
    plant = singer(model, held=np.arange(nv) == 7)
    N = plant.layout.size
    P = np.array(covariance(rng, N), order=order)
    q = model.integrate(model.neutral(), rng.normal(size=nv))
    state = DynamicState(q, rng.normal(size=nv), 20.0 * rng.normal(size=nv), np.zeros(12), P)
    sd = rng.uniform(0.0, 30.0, nv)
    predicted = plant.predict(state, sd)
    found = predicted.P
    step = DT * state.v + plant.c2 * state.a
    assert worst(predicted.q - model.integrate(q, step)) <= 1e-14
    assert worst(predicted.v - (state.v + plant.c1 * state.a)) <= 1e-13 * worst(state.v)
    np.testing.assert_array_equal(predicted.a, plant.rho * state.a)
    Q = np.zeros((N, N))
    Q[: 3 * nv, : 3 * nv] = np.kron(plant.covariance, np.diag(sd**2))
    Q[-6:, -6:] = np.diag(plant.layout.walk_variance(DT))
    phi = plant.transition(state)
    expected = phi @ P @ phi.T + Q
    scale = np.sqrt(np.diag(expected))
    assert (np.abs(found - expected) <= 1e-13 * np.outer(scale, scale)).all()
    np.testing.assert_array_equal(found, found.T)
    assert found.flags.f_contiguous
    assert replace(state, P=found).P is found


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_the_prediction_of_positions_and_velocities_is_phi_p_phi_and_noise(either_kernel, model):
    rng = np.random.default_rng(6)
    nv = model.nv
    plant = WhiteAccelerationPlant(model, DT, rng.uniform(0.0, 30.0, nv))
    P = covariance(rng, 2 * nv)
    state = KinematicState(model.integrate(model.neutral(), rng.normal(size=nv)), rng.normal(size=nv), P)
    found, phi = plant.predict(state).P, plant.transition(state)
    Q = np.block(
        [
            [np.diag(plant.position_noise), np.diag(plant.cross_noise)],
            [np.diag(plant.cross_noise), np.diag(plant.velocity_noise)],
        ]
    )
    expected = phi @ P @ phi.T + Q
    scale = np.sqrt(np.diag(expected))
    assert (np.abs(found - expected) <= 1e-13 * np.outer(scale, scale)).all()
    np.testing.assert_array_equal(found, found.T)
    assert found.flags.f_contiguous


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 10**6), st.integers(1, 40), st.integers(0, 20), st.integers(0, 9), st.sampled_from("CF")
)
def test_the_correction_is_the_covariance_times_what_is_read(seed, n, further, readings, order):
    rng = np.random.default_rng(seed)
    P = np.array(covariance(rng, n + further), order=order)
    rows, values, vector = (
        banded_rows(rng, readings, n + further),
        rng.normal(size=readings),
        rng.normal(size=n),
    )
    total = np.concatenate([vector, np.zeros(further)]) + rows.T @ values
    found = correction(P, vector, rows, values)
    assert (np.abs(found - P @ total) <= 1e-13 * (np.abs(P) @ np.abs(total))).all()


def test_the_correction_is_the_reference_s(reference_kernel):
    rng = np.random.default_rng(8)
    P, rows = covariance(rng, 12), banded_rows(rng, 3, 12)
    expected = P[:, :5] @ np.arange(5.0) + P @ rows.T @ np.ones(3)
    assert worst(correction(P, np.arange(5.0), rows, np.ones(3)) - expected) <= 1e-12 * worst(expected)


@needs_kernel
def test_threads_do_not_share_memory_to_work_in():
    """Its long calls let go of the interpreter's lock; each thread finds what it finds alone."""
    made = []
    for seed, N in enumerate((40, 120, 170, 90)):
        rng = np.random.default_rng(seed)
        made.append((covariance(rng, N), information(rng, N // 3, N), banded_rows(rng, 20, N)))
    alone = [informed_with_rows(*one) for one in made]
    with ThreadPoolExecutor(len(made)) as threads:
        for _ in range(50):
            together = list(threads.map(lambda one: informed_with_rows(*one), made))
            for found, expected in zip(together, alone, strict=True):
                np.testing.assert_array_equal(found, expected)
