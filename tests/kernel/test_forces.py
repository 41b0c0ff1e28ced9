"""Covariances of a body moved by forces go by the kernel as by the textbook's series and exactly."""

import numpy as np
import pytest

from mbkf.kernel.covariance import joint_ranges
from mbkf.kernel.forces import exact_step, light_step
from mbkf.numerics.forced_error import ForceDensity, ForcedRates, LightStep, forced_step
from tests.motions import random_model

pytestmark = pytest.mark.usefixtures("products")

MODEL, NU, DT = random_model(np.random.default_rng(4)), 13, 0.01
RANGES = joint_ranges(joint.v for joint in MODEL.joints.values())


def spread(rng, size):
    root = rng.normal(size=(size, size + 3)) * 10 ** rng.uniform(-1, 1, (size, 1))
    P = root @ root.T
    return np.tril(P) + np.tril(P, -1).T


def made(complete, damped=True, size=1.0):
    """F of a body's joints, some of whose forces push nothing, its noise and a covariance."""
    rng = np.random.default_rng(6)
    nv, turning = MODEL.nv, np.zeros((MODEL.nv, MODEL.nv))
    for first, end in RANGES:
        turning[first:end, first:end] = rng.normal(size=(end - first, end - first))
    U = rng.normal(size=(nv, NU))
    U[:, 3] = 0.0
    by_q, by_v = 30.0 * size * rng.normal(size=(nv, nv)), damped * rng.normal(size=(nv, nv))
    rates = ForcedRates(turning, by_q if complete else None, by_v if complete else None, U)
    own = np.where(rng.random(nv) < 0.2, rng.random(nv), 0.0)
    return rates, ForceDensity(own, spread(rng, NU)), spread(rng, 2 * nv + NU)


def assert_same(found, expected, tolerance):
    """Entries against the deviations of both components."""
    scale = np.sqrt(np.diag(expected))
    assert (np.abs(found - expected) <= tolerance * np.outer(scale, scale)).all()
    np.testing.assert_array_equal(found, found.T)


@pytest.mark.parametrize("second", [True, False])
@pytest.mark.parametrize("order", ["C", "F"])
def test_a_light_step_is_the_textbook_s_series(second, order):
    rates, density, P = made(complete=False)
    found = light_step(np.array(P, order=order), LightStep.of(rates, DT, second), RANGES, density)
    expected = forced_step(rates, density, DT, "second" if second else "first", "series").propagated(P)
    assert_same(found, expected, 1e-13)


@pytest.mark.parametrize(("complete", "damped"), [(True, True), (True, False), (False, False)])
@pytest.mark.parametrize("order", ["C", "F"])
def test_an_exact_step_is_the_series_of_blocks(complete, damped, order):
    rates, density, P = made(complete, damped)
    step, found = exact_step(np.array(P, order=order), rates, RANGES, density, DT)
    expected = forced_step(rates, density, DT, "exponential", "van_loan")
    scale = np.abs(expected.transition()).max(axis=1, keepdims=True)
    assert (np.abs(step.transition() - expected.transition()) <= 1e-13 * scale).all()
    assert_same(found, expected.propagated(P), 1e-12)


def test_an_exact_step_that_is_too_long_is_left_to_others():
    rates, density, P = made(complete=True, size=1e5)
    assert exact_step(P, rates, RANGES, density, DT) is None
    rates, density, P = made(complete=True)
    assert exact_step(P, rates._replace(by_q=np.full_like(rates.by_q, np.nan)), RANGES, density, DT) is None
