"""Smooth curves of time from which motions are made: quintic paths through knots, and small endless ripples."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import BPoly, PPoly, make_interp_spline

from mbkf.conventions import Array
from mbkf.synthesis.dual_numbers import Dual

Curve = Callable[[Array], Dual]
"""A quantity of time: (T,) times in s to a dual number of shape (T,) or (T, n)."""


def path(knots: Sequence[tuple], smooth: int = 2) -> Curve:
    """A curve through knots (time, value[, velocity[, acceleration[, jerk]]]); derivatives not given are 0.

    Args:
        knots: In order of time; the curve is constant outside.
        smooth: Number of continuous derivatives: 2 makes quintic pieces, 3 septic ones.
    """
    times = np.array([knot[0] for knot in knots], dtype=float)
    shape = np.shape(knots[0][1])
    rows = [
        [np.broadcast_to(np.asarray(d, dtype=float), shape) for d in (*knot[1:], 0.0, 0.0, 0.0)[: smooth + 1]]
        for knot in knots
    ]
    polynomial = PPoly.from_bernstein_basis(BPoly.from_derivatives(times, rows))

    def curve(at: Array) -> Dual:
        inside = np.clip(at, times[0], times[-1])
        moving = ((at >= times[0]) & (at <= times[-1])).reshape(at.shape + (1,) * len(shape))
        return Dual(
            polynomial(inside),
            np.where(moving, polynomial(inside, 1), 0.0),
            np.where(moving, polynomial(inside, 2), 0.0),
        )

    return curve


def spline(
    times: Sequence[float], values: Sequence[float], start: tuple[float, float], end: tuple[float, float]
) -> Curve:
    """The quintic spline through values.

    Args:
        times: Times of the values, s.
        values: The values.
        start: Rate and acceleration at the first time.
        end: Rate and acceleration at the last time.
    """
    bends = ([(1, start[0]), (2, start[1])], [(1, end[0]), (2, end[1])])
    polynomial = make_interp_spline(times, values, k=5, bc_type=bends)

    def curve(at: Array) -> Dual:
        inside = np.clip(at, times[0], times[-1])
        return Dual(polynomial(inside), polynomial(inside, 1), polynomial(inside, 2))

    return curve


def sinusoid(amplitude: float, frequency_hz: float, phase: float, offset: float = 0.0) -> Curve:
    """The curve offset + amplitude · sin(2π f t + phase).

    Args:
        amplitude: Amplitude, in the unit of the curve.
        frequency_hz: Frequency f.
        phase: Phase, rad.
        offset: Mean of the curve.
    """
    w = 2 * np.pi * frequency_hz

    def curve(at: Array) -> Dual:
        if amplitude == 0.0:
            return Dual.constant(np.full(at.shape, offset))
        angle = w * at + phase
        sine = amplitude * np.sin(angle)
        return Dual(offset + sine, amplitude * w * np.cos(angle), -(w**2) * sine)

    return curve


def added(*curves: Curve) -> Curve:
    """The sum of curves."""

    def curve(at: Array) -> Dual:
        total = curves[0](at)
        for other in curves[1:]:
            total = total + other(at)
        return total

    return curve


def scaled(factor: float, curve: Curve) -> Curve:
    """A curve times a number."""
    return lambda at: curve(at) * factor
