"""Functions of OpenSim's models of one argument: constants, lines, polynomials, splines and their multiples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.io.loose_xml import Element

LARGEST = 1e6
"""Bound of lengths (m, or mm by mistake), angles and coefficients of a body's joints."""

_SPLINES = ("SimmSpline", "NaturalCubicSpline")
_HOLDER = "function"
_MOST_HOLDERS = 4
_MOST_KNOTS = 2000


@dataclass(frozen=True)
class OsimFunction:
    """A function that is a polynomial between breaks.

    Attributes:
        breaks: (K,) arguments at which a piece ends and the next one begins, ascending.
        origins: (K + 1,) argument from which each piece counts its own.
        coefficients: (K + 1, D + 1) coefficients of each piece, lowest power first.
    """

    breaks: Array
    origins: Array
    coefficients: Array

    def __post_init__(self) -> None:
        for name in ("breaks", "origins", "coefficients"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def value(self, x: Array) -> Array:
        """Values at arguments x, in their shape."""
        return self._at(x, self.coefficients)

    def slope(self, x: Array) -> Array:
        """Derivatives at arguments x, in their shape."""
        powers = np.arange(1, self.coefficients.shape[1])
        return self._at(x, self.coefficients[:, 1:] * powers)

    @property
    def line(self) -> tuple[float, float] | None:
        """Offset and slope where the function is one line, a constant included; None where it bends."""
        if len(self.breaks) or self.coefficients[:, 2:].any():
            return None
        offset = float(self.value(np.zeros(1))[0])
        return offset, float(self.slope(np.zeros(1))[0])

    def scaled(self, factor: float) -> OsimFunction:
        """The function times a factor."""
        return OsimFunction(self.breaks, self.origins, factor * self.coefficients)

    def _at(self, x: Array, coefficients: Array) -> Array:
        piece = np.searchsorted(self.breaks, x, side="right")
        beyond = x - self.origins[piece]
        found = np.zeros(np.shape(x))
        for power in coefficients[piece].T[::-1]:
            found = found * beyond + power.T
        return found


def polynomial(*coefficients: float) -> OsimFunction:
    """A polynomial from its coefficients, lowest power first."""
    return OsimFunction(np.zeros(0), np.zeros(1), np.array([coefficients], float))


def function_of(element: Element, depth: int = _MOST_HOLDERS) -> OsimFunction | None:
    """The function that an element describes; None where its kind is not known or its numbers cannot be right.

    Args:
        element: The function's element, or one that holds it.
        depth: Number of elements around a function that are followed.
    """
    if depth == 0:
        return None
    text = element.child_text
    if element.tag in (_HOLDER, "MultiplierFunction", "coupled_coordinates_function"):
        inner = [one for one in element.children if one.tag not in ("scale", "value")]
        found = function_of(inner[0], depth - 1) if inner else None
        scale = number_list(text("scale"))
        return found if found is None or not scale else found.scaled(scale[0])
    if element.tag == "Constant":
        return polynomial(*(number_list(text("value")) or [0.0])[:1])
    if element.tag in ("LinearFunction", "PolynomialFunction"):  # highest power first
        coefficients = number_list(text("coefficients"))
        return polynomial(*coefficients[::-1]) if coefficients else None
    x, y = np.array(number_list(text("x"))), np.array(number_list(text("y")))
    if not 2 <= len(x) <= _MOST_KNOTS or len(x) != len(y) or not np.all(np.diff(x) > 0.0):
        return None
    if element.tag == "PiecewiseLinearFunction":
        return _piecewise(x, y, np.diff(y)[:, None] / np.diff(x)[:, None])
    return _simm_spline(x, y) if element.tag in _SPLINES else None


def number_list(text: str) -> list[float]:
    """Numbers of a body's size; empty where any word is something else."""
    try:
        found = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        return []
    return found if all(abs(number) <= LARGEST for number in found) else []


def _simm_spline(x: Array, y: Array) -> OsimFunction:
    """A cubic spline as SIMM and OpenSim have it.

    In its first and last piece the third derivative is that of the cubic through the four points at that end, and 0
    where there are three points (G. E. Forsythe, M. A. Malcolm, C. B. Moler, Computer Methods for Mathematical
    Computations, 1977, section 4.4).

    Args:
        x: (K,) arguments, ascending.
        y: (K,) values.
    """
    h, secants = np.diff(x), np.diff(y) / np.diff(x)
    if len(x) == 2:
        return _piecewise(x, y, secants[:, None])
    sixths = np.zeros((len(x), len(x)))  # of the second derivatives at the points
    right = np.zeros(len(x))
    for k in range(1, len(x) - 1):
        sixths[k, k - 1 : k + 2] = h[k - 1], 2.0 * (h[k - 1] + h[k]), h[k]
        right[k] = secants[k] - secants[k - 1]
    for row, end in ((0, slice(None, 4)), (-1, slice(-4, None))):
        near = 0 if row == 0 else len(x) - 2
        sixths[row, near : near + 2] = -1.0, 1.0
        right[row] = h[row] * _third_difference(x[end], y[end])
    bends = np.linalg.solve(sixths, right)
    inner = np.column_stack(
        [secants - h * (2.0 * bends[:-1] + bends[1:]), 3.0 * bends[:-1], np.diff(bends) / h]
    )
    return _piecewise(x, y, inner)


def _third_difference(x: Array, y: Array) -> float:
    """Third divided difference of four points; 0 of fewer."""
    if len(x) < 4:
        return 0.0
    for order in range(1, 4):
        y = np.diff(y) / (x[order:] - x[:-order])
    return float(y[0])


def _piecewise(x: Array, y: Array, inner: Array) -> OsimFunction:
    """Pieces between points (K,), and lines beyond the first and last one with the slopes there.

    Args:
        x: (K,) arguments.
        y: (K,) values.
        inner: (K - 1, D) coefficients of the powers from 1 on of the pieces.
    """
    last = np.diff(x)[-1]
    powers = np.arange(1, inner.shape[1] + 1)
    end_slope = float((inner[-1] * powers) @ last ** (powers - 1))
    outer = np.zeros((2, inner.shape[1]))
    outer[:, 0] = inner[0, 0], end_slope
    above = np.vstack([outer[:1], inner, outer[1:]])
    return OsimFunction(x, np.concatenate([x[:1], x]), np.column_stack([np.concatenate([y[:1], y]), above]))
