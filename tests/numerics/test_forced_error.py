"""A step of the error by its blocks is the step of the whole F, by every method."""

from itertools import product

import numpy as np
import pytest

from mbkf.numerics.discretisation import COVARIANCES, PROPAGATIONS, discretise
from mbkf.numerics.forced_error import ForceDensity, ForcedRates, LightStep, forced_step
from tests.motions import assert_near, worst

each_method = pytest.mark.parametrize(("propagation", "covariance"), list(product(PROPAGATIONS, COVARIANCES)))
NV, NU = 5, 7


def system(seed=1, complete=True, size=1.0):
    """F and noise of a made body, at sizes as a person's at 100 Hz; some velocities have no noise of their own."""
    rng = np.random.default_rng(seed)
    turning = rng.normal(size=(NV, NV))
    by_q, by_v = 300.0 * size * rng.normal(size=(NV, NV)), 5.0 * rng.normal(size=(NV, NV))
    root = rng.normal(size=(NU, NU))
    rates = ForcedRates(
        turning, by_q if complete else None, by_v if complete else None, rng.normal(size=(NV, NU))
    )
    return rates, ForceDensity(np.array([0.0, 2.0, 0.0, 0.5, 0.0]), root @ root.T)


def compared(found, expected, tolerance):
    """Entries of Φ against their row's largest, those of Q against the deviations of both."""
    scale = np.abs(expected.phi).max(axis=1, keepdims=True)
    assert worst((found.transition() - expected.phi) / scale) < tolerance
    sd = np.sqrt(np.diag(expected.noise))
    sd[sd == 0.0] = 1.0
    assert worst((found.covariance() - expected.noise) / np.outer(sd, sd)) < tolerance


@each_method
@pytest.mark.parametrize("complete", [True, False])
def test_blocks_make_the_step_of_the_whole(propagation, covariance, complete):
    rates, density = system(complete=complete)
    found = forced_step(rates, density, 0.01, propagation, covariance)
    compared(found, discretise(rates.matrix(), density.matrix(), 0.01, propagation, covariance), 1e-11)


@each_method
def test_long_steps_are_halved(propagation, covariance):
    rates, density = system(size=1000.0)
    found = forced_step(rates, density, 0.02, propagation, covariance)
    compared(found, discretise(rates.matrix(), density.matrix(), 0.02, propagation, covariance), 1e-11)


def test_a_covariance_goes_by_blocks():
    rates, density = system()
    step, rng = forced_step(rates, density, 0.01, "exponential", "van_loan"), np.random.default_rng(2)
    root = rng.normal(size=(2 * NV + NU,) * 2)
    P, phi = root @ root.T, step.transition()
    found = step.propagated(P)
    assert_near(found, phi @ P @ phi.T + step.covariance(), 1e-11 * worst(found))
    np.testing.assert_array_equal(found, found.T)


@pytest.mark.parametrize("propagation", ["first", "second"])
def test_a_light_step_is_the_simplified_one(propagation):
    rates, density = system(complete=False)
    light = LightStep.of(rates, 0.01, second=propagation == "second")
    expected = forced_step(rates, density, 0.01, propagation, "series").transition()
    assert_near(light.transition(), expected, 1e-15)


def test_the_mean_of_two():
    (one, _), (other, _) = system(1), system(2)
    assert_near(one.mean(other).matrix(), 0.5 * (one.matrix() + other.matrix()), 1e-13)
    (one, _), (other, _) = system(1, complete=False), system(2, complete=False)
    assert one.mean(other).by_q is None
    assert_near(one.mean(other).matrix(), 0.5 * (one.matrix() + other.matrix()), 1e-13)
