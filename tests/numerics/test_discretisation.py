"""Transition and plant noise against closed forms, Van Loan's own exponential and their orders of convergence."""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg

from mbkf.errors import UnknownName
from mbkf.numerics.discretisation import (
    PROPAGATIONS,
    discretise,
    exponential,
    first_order,
    second_order,
    series_covariance,
    van_loan,
)
from tests.motions import assert_near, worst


def random_system(seed, size=7, constant=2):
    """F (n, n) whose last rows are zero, and a density Σ (n, n)."""
    rng = np.random.default_rng(seed)
    F = rng.normal(size=(size, size))
    F[size - constant :] = 0.0
    A = rng.normal(size=(size, size))
    return F, A @ A.T


def block_exponential(F, density, dt):
    """Van Loan's formula as printed (thesis eqs. 2.43, 2.44)."""
    n = len(F)
    V = np.block([[-F, density], [np.zeros((n, n)), F.T]])
    powers = scipy.linalg.expm(dt * V)
    phi = powers[n:, n:].T
    return phi, phi @ powers[:n, n:]


@pytest.mark.parametrize("constant", [0, 2, 7])
@pytest.mark.parametrize("dt", [0.01, 0.5, 3.0])
def test_van_loan_is_the_block_exponential(dt, constant):
    F, density = random_system(1, constant=constant)
    phi, noise = block_exponential(F, density, dt)
    found = van_loan(F, density, dt)
    assert_near(found.phi, phi, 1e-11 * max(1.0, worst(phi)))
    assert_near(found.noise, noise, 1e-11 * worst(noise))


def test_van_loan_bears_badly_scaled_states():
    """Torques of hundreds of N m on a foot of 1e-3 kg m² beside positions of millimetres."""
    F, density = random_system(2)
    scale = 10.0 ** np.arange(-3, 4)
    F, density = scale[:, None] * F / scale, scale[:, None] * density * scale
    phi, noise = block_exponential(F, density, 0.02)
    found = van_loan(F, density, 0.02)
    assert worst((found.phi - phi) / scale[:, None] * scale) < 1e-12
    assert worst((found.noise - noise) / scale[:, None] / scale) < 1e-11


def test_van_loan_is_the_convolution_integral():
    F, density = random_system(3, size=4, constant=1)

    def integrand(s):
        phi = scipy.linalg.expm(s * F)
        return (phi @ density @ phi.T).ravel()

    integral = scipy.integrate.quad_vec(integrand, 0.0, 0.7, epsabs=1e-12)[0].reshape(4, 4)
    assert_near(van_loan(F, density, 0.7).noise, integral, 1e-9)


def test_a_double_integrator_has_the_textbook_noise():
    F, density, t = np.array([[0.0, 1.0], [0.0, 0.0]]), np.diag([0.0, 2.0]), 0.3
    noise = 2.0 * np.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])
    assert_near(van_loan(F, density, t).noise, noise, 1e-15)
    assert_near(series_covariance(F, density, t), noise, 1e-15)
    for propagate in PROPAGATIONS.values():
        assert_near(propagate(F, t), [[1.0, t], [0.0, 1.0]], 1e-15)


def measured_order(error, steps=(0.04, 0.02, 0.01)):
    return np.polyfit(np.log(steps), np.log([error(h) for h in steps]), 1)[0]


@pytest.mark.parametrize(("propagate", "order"), [(first_order, 2), (second_order, 3)])
def test_error_of_a_truncated_transition_falls_with_its_order(propagate, order):
    F, _ = random_system(4)
    found = measured_order(lambda h: worst(propagate(F, h) - exponential(F, h)))
    assert found == pytest.approx(order, abs=0.1)


def test_error_of_the_series_covariance_is_of_third_order():
    """Thesis eq. 2.45 takes Φ = I + F t in the integral, which neglects F² Σ t³/6 and its transpose."""
    F, density = random_system(5)
    found = measured_order(lambda h: worst(series_covariance(F, density, h) - van_loan(F, density, h).noise))
    assert found == pytest.approx(3.0, abs=0.1)


def test_two_half_steps_make_a_whole_one():
    F, density = random_system(6)
    half, whole = van_loan(F, density, 0.1), van_loan(F, density, 0.2)
    assert_near(half.phi @ half.phi, whole.transition(), 1e-13)
    assert_near(half.phi @ half.noise @ half.phi.T + half.noise, whole.noise, 1e-12)


@pytest.mark.parametrize("covariance", ["series", "van_loan"])
@pytest.mark.parametrize("propagation", PROPAGATIONS)
def test_every_combination_by_name(propagation, covariance):
    F, density = random_system(7)
    found = discretise(F, density, 0.02, propagation, covariance)
    assert_near(found.phi, PROPAGATIONS[propagation](F, 0.02), 1e-13)
    exact = van_loan(F, density, 0.02).noise
    expected = exact if covariance == "van_loan" else series_covariance(F, density, 0.02)
    assert_near(found.noise, expected, 1e-14)
    np.testing.assert_array_equal(found.noise, found.noise.T)


def test_unknown_names_are_refused():
    F, density = random_system(8)
    with pytest.raises(UnknownName, match="propagation"):
        discretise(F, density, 0.1, "third", "series")
    with pytest.raises(UnknownName, match="covariance"):
        discretise(F, density, 0.1, "first", "van loon")
