"""Coordinates of an OpenSim model that bring points of its bodies nearest to given places, frame by frame.

Levenberg–Marquardt on Σ w² |p(x) − target|² over the free coordinates x of each frame, all frames of a block at once.
Coordinates that the model clamps stay within their range: a step is cut at it, and a coordinate at its limit that the
gradient pushes out is left out of the step (the projected Newton method: D. P. Bertsekas, SIAM J. Control Optim. 20
(1982) 221-246). Constraints between coordinates hold exactly, as the free coordinates are the unknowns. Those that move
no point keep their default.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.model.osim_kinematics import GROUND, OsimKinematics

ROUNDS = 60
"""Most steps of a frame."""

FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-9, 1e8
"""Share of the normal matrix's diagonal that is added to it: at first, at least, and where a frame is given up."""

EASED, TIGHTENED = 0.2, 8.0
"""Factors of the damping after a step that came nearer, and after one that did not."""

SETTLED = 1e-9
"""A frame is settled when no coordinate moves by more, rad or m."""

RIDGE = 1e-9
"""Stiffness, m² per rad² or m² of squared residual, that keeps coordinates which move no point where they are."""

KEY_S = 0.1
"""Time between frames that are followed one after another; the frames between them start from these."""

ALIKE, EXACT_M2 = 1.01, 1e-9
"""Poses fit alike whose costs differ by less than this factor, or by less than this squared residual, m²: those of an
exact fit are rounding alone. Turns by other angles may give one pose."""

BLOCK = 200
"""Number of frames that are solved at once."""


@dataclass(frozen=True)
class Targets:
    """Places that P points of a model's bodies shall come to.

    Attributes:
        bodies: (P,) numbers of the bodies.
        places_m: (P, 3) the points in their bodies' frames, m.
        at_m: (T, P, 3) where they shall be, in the ground's axes, m; NaN where not known.
        weights: (P,) how much each counts.
    """

    bodies: NDArray[np.intp]
    places_m: Array
    at_m: Array
    weights: Array


def fit(kinematics: OsimKinematics, targets: Targets, rate_hz: float, start: Array | None = None) -> Array:
    """(T, C) coordinates in which the model's points are nearest to their targets.

    The first frame is found from the default pose with the root turned about each of its axes by quarters of a turn,
    and has the angles nearest to that pose where several sets of angles fit; the others follow from their neighbours.

    Args:
        kinematics: The model.
        targets: Where its points shall be.
        rate_hz: Frames per second.
        start: (C,) coordinates near those of the first frame, where they are known.
    """
    frames = len(targets.at_m)
    x = np.empty((frames, len(kinematics.free)))
    step = max(1, round(KEY_S * rate_hz))
    latest = _first(kinematics, targets) if start is None else start[kinematics.free]
    keys = np.arange(0, frames, step)
    for key in keys:
        latest = x[key] = _solved(kinematics, targets, np.array([key]), latest[None])[0]
    nearest = keys[np.minimum((np.arange(frames) + step // 2) // step, len(keys) - 1)]
    for begin in range(0, frames, BLOCK):
        rows = np.arange(begin, min(begin + BLOCK, frames))
        x[rows] = _solved(kinematics, targets, rows, x[nearest[rows]])
    return kinematics.expanded(x)[0]


def _first(kinematics: OsimKinematics, targets: Targets) -> Array:
    """(N,) free coordinates of the first frame: of the poses that fit best the one nearest to the default."""
    free = [kinematics.model.coordinates[number] for number in kinematics.free]
    root = {
        one.name
        for joint in kinematics.model.joints
        if joint.parent == GROUND
        for one in joint.coordinates
        if one.rotational
    }
    turning = [place for place, one in enumerate(free) if one.name in root][:3]
    quarters = list(product(np.pi / 2.0 * np.arange(-1, 3), repeat=len(turning)))
    default = kinematics.defaults[kinematics.free]
    starts = np.tile(default, (len(quarters), 1))
    starts[:, turning] = quarters
    turns = kinematics.poses(kinematics.expanded(starts)[0]).rotations[:, 0].reshape(len(starts), 9)
    starts = starts[np.unique(turns.round(3) + 0.0, axis=0, return_index=True)[1]]
    frame = np.zeros(len(starts), int)
    found = _solved(kinematics, targets, frame, starts)
    whole = np.array([one.rotational and not one.clamped for one in free])
    found -= whole * 2.0 * np.pi * np.round((found - default) / (2.0 * np.pi))
    found = _solved(kinematics, targets, frame, found)
    costs = (_residuals(kinematics, targets, frame, found)[0] ** 2).sum(axis=1)
    far = (np.where([one.rotational for one in free], found - default, 0.0) ** 2).sum(axis=1)
    return found[np.argmin(np.where(costs <= ALIKE * costs.min() + EXACT_M2, far, np.inf))]


def _solved(kinematics: OsimKinematics, targets: Targets, rows: NDArray[np.intp], start: Array) -> Array:
    """(R, N) free coordinates of some frames, from a start (R, N)."""
    lowest, highest = _limits(kinematics)
    x = np.clip(start, lowest, highest)
    damping, open_ = np.full(len(rows), FIRST_DAMPING), np.ones(len(rows), dtype=bool)
    r, J = _residuals(kinematics, targets, rows, x)
    cost = (r**2).sum(axis=1)
    for _ in range(ROUNDS):
        k = np.flatnonzero(open_)
        if not len(k):
            break
        tried = np.clip(x[k] + _step(r[k], J[k], x[k], damping[k], lowest, highest), lowest, highest)
        new_r, new_J = _residuals(kinematics, targets, rows[k], tried)
        new_cost = (new_r**2).sum(axis=1)
        better = new_cost <= cost[k]
        small = np.abs(tried - x[k]).max(axis=1) < SETTLED
        b = k[better]
        x[b], r[b], J[b], cost[b] = tried[better], new_r[better], new_J[better], new_cost[better]
        damping[k] *= np.where(better, EASED, TIGHTENED)
        damping = np.maximum(damping, LEAST_DAMPING)
        open_[k] = ~small & (damping[k] < MOST_DAMPING)
    return x


def _step(r: Array, J: Array, x: Array, damping: Array, lowest: Array, highest: Array) -> Array:
    """(R, N) damped step of each frame; 0 for coordinates at a limit that the gradient pushes out."""
    gradient = np.einsum("rmn,rm->rn", J, r)
    held = ((x <= lowest) & (gradient > 0.0)) | ((x >= highest) & (gradient < 0.0))
    J = np.where(held[:, None, :], 0.0, J)
    H = np.swapaxes(J, 1, 2) @ J
    n = np.arange(x.shape[1])
    H[:, n, n] += damping[:, None] * H[:, n, n] + RIDGE
    return np.asarray(-np.linalg.solve(H, np.where(held, 0.0, gradient)[..., None])[..., 0])


def _residuals(
    kinematics: OsimKinematics, targets: Targets, rows: NDArray[np.intp], x: Array
) -> tuple[Array, Array]:
    """(R, 3 P) weighted distances of points from their targets, and (R, 3 P, N) their derivatives."""
    q, by = kinematics.expanded(x)
    points, J = kinematics.poses(q).points(targets.bodies, targets.places_m)
    apart = points - targets.at_m[rows]
    weights = np.where(np.isfinite(apart).all(axis=2), targets.weights, 0.0)[..., None]
    r = np.where(weights > 0.0, weights * np.nan_to_num(apart), 0.0)
    J = (weights[..., None] * J).reshape(len(rows), -1, J.shape[3]) @ by
    return r.reshape(len(rows), -1), J


def _limits(kinematics: OsimKinematics) -> tuple[Array, Array]:
    """(N,) least and greatest values of the free coordinates; ±inf where the model does not clamp them."""
    free = [kinematics.model.coordinates[number] for number in kinematics.free]
    lowest = np.array([one.lowest if one.clamped else -np.inf for one in free])
    return lowest, np.array([one.highest if one.clamped else np.inf for one in free])
