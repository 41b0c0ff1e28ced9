"""Jets against complex-free truths: derivatives of products, quotients, roots, rotations."""

import numpy as np
import pytest

from mbkf.synthesis import dual_numbers
from mbkf.synthesis.curves import added, path, scaled, sinusoid, spline
from mbkf.synthesis.dual_numbers import Dual

TIMES = np.linspace(0.1, 0.9, 9)
CURVES = {
    "product": lambda t: sinusoid(1.0, 0.7, 0.3, 2.0)(t) * sinusoid(0.5, 1.1, 0.1)(t),
    "quotient": lambda t: sinusoid(1.0, 0.7, 0.3)(t) / sinusoid(0.5, 1.1, 0.1, 2.0)(t),
    "root": lambda t: dual_numbers.sqrt(sinusoid(1.0, 0.7, 0.3, 2.0)(t)),
    "arccos": lambda t: dual_numbers.arccos(sinusoid(0.6, 0.7, 0.3)(t)),
    "sine": lambda t: dual_numbers.sin(sinusoid(2.0, 0.7, 0.3)(t)),
    "path": path([(0.0, 0.0, 1.0, 2.0), (1.0, 3.0)]),
    "spline": spline([0.0, 0.3, 0.7, 1.0], [0.0, 1.0, 0.5, 2.0], (1.0, 0.0), (0.0, 3.0)),
    "sum": added(sinusoid(1.0, 0.7, 0.3), scaled(2.0, path([(0.0, 0.0), (1.0, 1.0)], smooth=3))),
    "cross": lambda t: dual_numbers.cross(vector(t), vector(t + 0.3)),
    "cross with a constant": lambda t: dual_numbers.cross(vector(t), np.array([0.3, -1.0, 2.0])),
    "inverse": lambda t: 2.0 / sinusoid(0.5, 1.1, 0.1, 2.0)(t),
    "unit": lambda t: dual_numbers.unit(vector(t)),
    "rotation": lambda t: dual_numbers.euler([sinusoid(1.0, f, 0.2)(t) for f in (0.3, 0.5, 0.7)]),
}


def vector(t):
    return dual_numbers.stack([sinusoid(1.0, f, f, 2.0)(t) for f in (0.3, 0.5, 0.9)])


@pytest.mark.parametrize("name", CURVES)
def test_derivatives_agree_with_finite_differences(name):
    curve, h = CURVES[name], 1e-4
    here, ahead, behind = curve(TIMES), curve(TIMES + h), curve(TIMES - h)
    assert np.allclose((ahead.value - behind.value) / (2 * h), here.first, atol=2e-6)
    assert np.allclose((ahead.first - behind.first) / (2 * h), here.second, atol=2e-5)


def test_local_rates_are_those_of_the_rotating_frame():
    angle = sinusoid(1.0, 0.4, 0.1)(TIMES)
    rate, change = dual_numbers.local_rates(dual_numbers.rotation(2, angle))
    assert np.allclose(rate, np.outer(angle.first, [0, 0, 1]))
    assert np.allclose(change, np.outer(angle.second, [0, 0, 1]))


def test_arrays_on_either_side_leave_the_arithmetic_to_the_jet():
    x = Dual(TIMES, np.ones_like(TIMES), np.zeros_like(TIMES))
    assert np.allclose((TIMES * x).first, TIMES)
    assert np.allclose((1.0 - x).first, -1.0)
    assert np.allclose((TIMES + x).value, 2 * TIMES)


@pytest.mark.parametrize("name", CURVES)
def test_results_lack_the_derivatives_that_factors_lack(name):
    whole = CURVES[name](TIMES)
    for order in range(3):
        product = whole.upto(order) * whole
        assert np.array_equal(product.orders, (whole * whole).orders[: order + 1])


def test_rotations_of_several_joints_at_once_are_those_of_each():
    angles = [vector(TIMES + k) for k in range(3)]
    together = dual_numbers.euler(angles)
    for joint in range(3):
        alone = dual_numbers.euler([angle[:, joint] for angle in angles])
        assert np.allclose(together[:, joint].orders, alone.orders, rtol=0.0, atol=1e-12)


def test_path_is_constant_outside_its_knots():
    outside = path([(0.0, 1.0), (1.0, 2.0)])(np.array([-1.0, 3.0]))
    assert np.array_equal(outside.value, [1.0, 2.0])
    assert not outside.first.any()
