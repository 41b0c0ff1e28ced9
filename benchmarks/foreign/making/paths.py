"""Smooth paths through given points in time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.interpolate import BPoly

from mbkf.conventions import Array


def minimum_jerk(times_s: Array, knots: Sequence[tuple[float, float]]) -> Array:
    """(T,) a value that rests at each knot and moves between them with the least jerk.

    Args:
        times_s: (T,) times.
        knots: Times and values, in order.
    """
    found = np.full(len(times_s), knots[0][1])
    for (start, before), (stop, after) in pairwise(knots):
        x = np.clip((times_s - start) / (stop - start), 0.0, 1.0)
        found += (after - before) * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    return found


def between(times_s: Array, knots: Sequence[tuple[float, float, float, float]]) -> Array:
    """(T,) polynomials of fifth degree through times, values, velocities and accelerations; at rest outside.

    Args:
        times_s: (T,) times.
        knots: Time, value, velocity and acceleration, in order of time.
    """
    path = BPoly.from_derivatives([one[0] for one in knots], [one[1:] for one in knots])
    return np.asarray(path(np.clip(times_s, knots[0][0], knots[-1][0])))
