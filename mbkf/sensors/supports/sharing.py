"""Division of a wrench among the loaded parts: by their areas, as far as its line of action allows.

Part i carries (f_i, n_i), its moment about its own middle c_i. A priori each has a share of the force by its area, the
square of its lever, with a spread of half the whole force, and a moment of its lever times its share. That their
wrenches sum to the whole one conditions this Gaussian exactly; the remaining covariance is the spread of the shares.
Only hands may pull.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.rotations import skew

SPREAD_SHARE = 0.5
"""A priori spread of a part's force, as a share of the whole."""

LEAST_FORCE_N = 10.0
"""Least force by which the spread of the shares is computed."""


class Shares(NamedTuple):
    """Wrenches of n parts.

    Attributes:
        wrench: (n, 6) about the world's origin.
        by_whole: (n, 6, 6) derivative by the whole wrench.
        covariance: (6 n, 6 n) of the shares of a known whole.
    """

    wrench: Array
    by_whole: Array
    covariance: Array


def shares(whole: Array, points_m: Array, levers_m: Array, pulls: Sequence[bool]) -> Shares:
    """A wrench divided among parts.

    Args:
        whole: (6,) force N and moment N m about the world's origin.
        points_m: (n, 3) middles of the parts.
        levers_m: (n,) largest distances of the centres of pressure from them.
        pulls: True for parts that may pull: hands that hold something.
    """
    used = np.ones(len(points_m), dtype=bool)
    while True:
        found = _shared(whole, points_m, levers_m, used)
        pulling = used & (found.wrench[:, 2] < 0.0) & ~np.asarray(pulls, dtype=bool)
        if not pulling.any() or used.sum() == 1:
            return found
        used[int(np.argmin(np.where(pulling, found.wrench[:, 2], np.inf)))] = False


def _shared(whole: Array, points_m: Array, levers_m: Array, used: BoolArray) -> Shares:
    n, areas = len(points_m), np.where(used, levers_m, 0.0) ** 2
    expected = areas / areas.sum()
    force = max(float(np.linalg.norm(whole[:3])), LEAST_FORCE_N)
    # G maps (f_i, n_i) of all parts to the whole wrench about the origin, mean the whole wrench to their prior.
    G, mean, variance = np.zeros((6, 6 * n)), np.zeros((6 * n, 6)), np.zeros(6 * n)
    for k in np.flatnonzero(used).tolist():
        own = slice(6 * k, 6 * k + 6)
        G[:, own] = about(-points_m[k])
        mean[6 * k : 6 * k + 3, :3] = expected[k] * np.eye(3)
        variance[own] = np.repeat([SPREAD_SHARE * force, levers_m[k] * force * expected[k]], 3) ** 2
    gain = variance[:, None] * G.T @ np.linalg.inv(G * variance @ G.T)
    local = mean + gain @ (np.eye(6) - G @ mean)
    spread = np.diag(variance) - gain @ (G * variance)
    back = np.zeros((6 * n, 6 * n))
    for k in range(n):
        back[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = about(-points_m[k])
    by_whole = (back @ local).reshape(n, 6, 6)
    return Shares(by_whole @ whole, by_whole, back @ spread @ back.T)


def about(point_m: Array) -> Array:
    """(6, 6) transform of a wrench about the world's origin to a point (3,)."""
    X = np.eye(6)
    X[3:, :3] = -skew(point_m)
    return X
