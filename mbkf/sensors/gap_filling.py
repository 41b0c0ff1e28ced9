"""Places of markers in gaps: on the body, with the expected offset of the skin.

A marker's offset from the rigid body, in its segment's axes, is a smooth random process: skin slides slowly, so that
the offset and its rate just before a gap, and just after it, predict those within. It is also partly common to the
markers of a segment (they ride on the same flesh, and a wrong pose displaces all of them as one), so that the markers
seen in the gap add information. Both are one Gaussian process, and its mean is the estimate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.motion_frames import motion_frames
from mbkf.sensors.marker_sensor import MarkerSensor

SKIN_MEMORY_S = 0.2
"""Correlation time of the process (Matérn, 3/2)."""

SIGHTS = 10
"""Number of sights before a gap, and after it, that count."""

SIGHT_VARIANCE = 0.01
"""Variance of a sight over that of the offset."""

TURN_RAD_M = 10.0
"""Common part of a segment's markers: they shift as much as each slides alone, and turn by this angle per metre that
each slides alone (the same shift again at 0.1 m from their middle)."""


STRANGE_M = 0.05
"""A marker farther than this from the place expected by its own sights is not on sliding skin; the others ignore it."""


@dataclass(frozen=True)
class _Gap:
    """Frames [first, end) in which a marker is not seen, and the frames (k,) of the sights around it."""

    first: int
    end: int
    sights: NDArray[np.int64]


def filled(
    sensor: MarkerSensor, q: Array, shown_m: Array, dt_s: float, both_sides: bool
) -> tuple[Array, Array]:
    """(T, M, 3) markers on the body and (T, M, 3) the same with skin offsets where a marker is not shown.

    Args:
        sensor: The markers on the body.
        q: (T, nq) configurations, NaN where the body is not followed.
        shown_m: (T, M, 3) markers as the filter saw them, NaN where missing.
        dt_s: Time between frames.
        both_sides: True to use sights after a gap, too (smoothing).
    """
    segments = motion_frames(sensor.model, q)[0][:, sensor.joint_ids]
    axes, local = segments[:, :, :3], np.zeros(shown_m.shape)  # rows are axes
    for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
        local[t] = sensor.local_at(q[t])
    on_body = segments[:, :, 3] + np.einsum("tmji,tmj->tmi", axes, local)
    offset = np.einsum("tmij,tmj->tmi", axes, shown_m - on_body)
    with_skin = on_body + np.einsum("tmji,tmj->tmi", axes, _expected(sensor, offset, dt_s, both_sides))
    return on_body, with_skin


def _expected(sensor: MarkerSensor, offset: Array, dt_s: float, both_sides: bool) -> Array:
    """(T, M, 3) expected offsets in gaps, zero elsewhere and for a marker that was never seen."""
    expected = np.zeros_like(offset)
    for joint in np.unique(sensor.joint_ids):
        members = np.flatnonzero(sensor.joint_ids == joint)
        own = offset[:, members]
        seen = np.asarray(~np.isnan(own).any(axis=2))
        shared = shared_covariance(sensor.local_m[members])
        for k, marker in enumerate(members):
            for gap in _gaps(seen[:, k], both_sides):
                expected[gap.first : gap.end, marker] = _in_gap(k, gap, own, seen, shared, dt_s)
    return expected


def _gaps(seen: BoolArray, both_sides: bool) -> Iterator[_Gap]:
    """Gaps of one marker that have sights."""
    edges = np.diff(np.r_[0, ~seen, 0].astype(int))
    known = np.flatnonzero(seen)
    for first, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        before = known[known < first][-SIGHTS:]
        after = known[known >= end][:SIGHTS] if both_sides else known[:0]
        if len(before) + len(after):
            yield _Gap(int(first), int(end), np.r_[before, after])


def _in_gap(k: int, gap: _Gap, offset: Array, seen: BoolArray, shared: Array, dt_s: float) -> Array:
    """(L, 3) expected offsets of marker k of a segment in its gap.

    Its sights around the gap come first. The segment's other markers are predicted from theirs at the same frames, as
    if they were hidden as well; the common part of their differences from that is added.

    Args:
        k: The marker among the segment's n.
        gap: Its gap of L frames, with its sights.
        offset: (T, n, 3) offsets, NaN where not seen.
        seen: (T, n) seen markers.
        shared: (n, 3, n, 3) covariance of the offsets of a frame.
        dt_s: Time between frames.
    """
    frames = np.arange(gap.first, gap.end)
    expected, spread = _from_sights(offset[gap.sights, k], gap.sights, frames, dt_s)
    surprise = np.zeros((len(frames), len(shared), 3))
    informs = np.zeros((len(frames), len(shared)), dtype=bool)
    for j in range(len(shared)):
        at = gap.sights[seen[gap.sights, j]]
        if len(at) and seen[frames, j].any():
            mean, sd = _from_sights(offset[at, j], at, frames, dt_s)
            difference = offset[frames, j] - mean
            informs[:, j] = np.linalg.norm(difference, axis=1) < STRANGE_M
            surprise[:, j] = difference / sd[:, None]
    for pattern in np.unique(informs, axis=0):
        if pattern.any():
            rows = (informs == pattern).all(axis=1)
            among = shared[pattern][:, :, pattern].reshape(3 * pattern.sum(), -1)
            passed_on = np.linalg.solve(among, shared[pattern][:, :, k].reshape(-1, 3))
            known = surprise[np.ix_(rows, pattern)].reshape(rows.sum(), -1)
            expected[rows] += spread[rows, None] * (known @ passed_on)
    return expected


def _from_sights(
    sighted: Array, at: NDArray[np.int64], frames: NDArray[np.int64], dt_s: float
) -> tuple[Array, Array]:
    """(L, 3) mean and (L,) standard deviation of the process at some frames, given sights at others.

    Args:
        sighted: (k, 3) offsets.
        at: (k,) their frames.
        frames: (L,) the frames wanted.
        dt_s: Time between frames.
    """
    at_s: Array = dt_s * at.astype(float)
    frames_s: Array = dt_s * frames.astype(float)
    between = correlation(at_s[:, None] - at_s) + SIGHT_VARIANCE * np.eye(len(at))
    towards = correlation(at_s[:, None] - frames_s)
    weights = np.linalg.solve(between, towards)
    variance = 1.0 - np.einsum("kl,kl->l", towards, weights)
    return weights.T @ sighted, np.sqrt(variance)


def correlation(apart_s: Array) -> Array:
    """Correlation of an offset with itself some time later (Matérn, 3/2)."""
    steps = np.sqrt(3.0) * np.abs(apart_s) / SKIN_MEMORY_S
    return np.asarray((1.0 + steps) * np.exp(-steps))


def shared_covariance(places_m: Array) -> Array:
    """(n, 3, n, 3) covariance of the offsets of a segment's markers, over the variance of each marker's own slide.

    Args:
        places_m: (n, 3) the markers in the segment's axes.
    """
    count = len(places_m)
    arms = places_m - places_m.mean(axis=0)
    turned = TURN_RAD_M * np.array([np.cross(axis, arms).ravel() for axis in np.eye(3)])
    shifted = np.tile(np.eye(3), count)
    covariance = np.eye(3 * count) + shifted.T @ shifted + turned.T @ turned
    return np.asarray(covariance.reshape(count, 3, count, 3))
