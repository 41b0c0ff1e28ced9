"""OpenSim's functions of one argument: values, slopes, ends, and the spline of SIMM."""

import numpy as np
import pytest

from mbkf.io.loose_xml import parse_loose_xml
from mbkf.io.osim_functions import function_of


def function(text):
    (element,) = parse_loose_xml(text).children
    return function_of(element)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("<Constant><value>0.25</value></Constant>", 0.25),
        ("<LinearFunction><coefficients>2 0.5</coefficients></LinearFunction>", 0.5),
        ("<PolynomialFunction><coefficients>3 2 1 -0.75</coefficients></PolynomialFunction>", -0.75),
        ("<function><Constant><value>4</value></Constant></function>", 4.0),
        ("<PiecewiseLinearFunction><x>-1 1</x><y>0 3</y></PiecewiseLinearFunction>", 1.5),
        ("<SimmSpline><x>-2 -1 1 2</x><y>-3 -1 3 5</y></SimmSpline>", 1.0),
        ("<NaturalCubicSpline><x>-1 0 1</x><y>7 0.125 -9</y></NaturalCubicSpline>", 0.125),
        ("<SimmSpline><x>-1 1</x><y>1 2</y></SimmSpline>", 1.5),
        (
            "<MultiplierFunction><function><SimmSpline><x>-1 0 1</x><y>1 2 5</y></SimmSpline></function>"
            "<scale>1.5</scale></MultiplierFunction>",
            3.0,
        ),
    ],
)
def test_functions_at_zero(text, value):
    assert function(text).value(np.zeros(1)) == pytest.approx(value)


@pytest.mark.parametrize(
    "text",
    [
        "<SimmSpline><x>0</x><y>1</y></SimmSpline>",
        "<SimmSpline><x>0 0</x><y>1 2</y></SimmSpline>",
        "<LinearFunction><coefficients>1 x</coefficients></LinearFunction>",
        "<Unheard/>",
        "<function>" * 9 + "<Constant><value>1</value></Constant>" + "</function>" * 9,
    ],
)
def test_functions_that_are_not_known(text):
    assert function(text) is None


CUBIC = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0])
X = np.array([-1.0, -0.6, 0.1, 0.2, 0.9])


def test_a_spline_through_points_of_a_cubic_is_the_cubic_and_goes_on_straight():
    """End conditions by the third divided differences keep a cubic; those of a natural spline do not."""
    y = " ".join(map(str, CUBIC(X)))
    spline = function(f"<SimmSpline><x>{' '.join(map(str, X))}</x><y>{y}</y></SimmSpline>")
    inside = np.linspace(-1.0, 0.9, 40).reshape(4, 10)
    assert spline.value(inside) == pytest.approx(CUBIC(inside))
    assert spline.slope(inside) == pytest.approx(CUBIC.deriv()(inside))
    for end, beyond in ((X[0], -3.0), (X[-1], 4.0)):
        slope = CUBIC.deriv()(end)
        assert spline.value(np.array(beyond)) == pytest.approx(CUBIC(end) + slope * (beyond - end))
        assert spline.slope(np.array(beyond)) == pytest.approx(slope)


def test_three_points_give_their_parabola():
    spline = function("<SimmSpline><x>0 1 3</x><y>0 1 9</y></SimmSpline>")
    assert spline.value(np.array([0.5, 2.0])) == pytest.approx([0.25, 4.0])


def test_lines_are_known_as_such():
    line = function("<PolynomialFunction><coefficients>0 3 -2</coefficients></PolynomialFunction>")
    assert line.line == (-2.0, 3.0)
    assert line.scaled(2.0).line == (-4.0, 6.0)
    bent = function("<PolynomialFunction><coefficients>1 0 0</coefficients></PolynomialFunction>")
    broken = function("<PiecewiseLinearFunction><x>0 1 2</x><y>0 1 2</y></PiecewiseLinearFunction>")
    assert bent.line is None and broken.line is None
