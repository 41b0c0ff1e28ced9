"""Where a marker is while no camera sees it: on the body, and as far off it as its skin was when last seen.

Skin slides slowly, so a marker's offset from the rigid body outlives a short gap. In its segment's axes it is taken
for a Gauss–Markov process: its best estimate fades after the last sight, and bridges a gap where both ends are known.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.marker_sensor import MarkerSensor

SKIN_MEMORY_S = 0.3
"""How long skin stays where it slid: the swing of a step."""


def filled(
    sensor: MarkerSensor, q: Array, shown_m: Array, dt_s: float, both_sides: bool
) -> tuple[Array, Array]:
    """(T, M, 3) markers on the body and (T, M, 3) the same with skin offsets where a marker is not shown.

    Args:
        sensor: The markers on the body.
        q: (T, nq) configurations, NaN where the body is not followed.
        shown_m: (T, M, 3) markers as the filter saw them, NaN where missing.
        dt_s: Time between frames.
        both_sides: Whether the sight after a gap may be used, too (smoothing).
    """
    frames, markers = shown_m.shape[:2]
    on_body = np.full((frames, markers, 3), np.nan)
    axes = np.full((frames, markers, 3, 3), np.nan)
    for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
        rotations, origins = sensor.model.placements(q[t])
        axes[t] = rotations[sensor.joint_ids]
        on_body[t] = origins[sensor.joint_ids] + np.einsum("mij,mj->mi", axes[t], sensor.local_m)
    offset = np.einsum("tmji,tmj->tmi", axes, shown_m - on_body)
    with_skin = on_body.copy()
    for m in range(markers):
        bridged = _bridged(offset[:, m], dt_s, both_sides)
        with_skin[:, m] += np.einsum("tij,tj->ti", axes[:, m], bridged)
    return on_body, with_skin


def _bridged(offset: Array, dt_s: float, both_sides: bool) -> Array:
    """(T, 3) expected offset of one marker, zero where it is seen or was never seen."""
    frames = np.arange(len(offset))
    seen: BoolArray = ~np.isnan(offset[:, 0])
    expected = np.zeros_like(offset)
    if not seen.any():
        return expected
    before = np.maximum.accumulate(np.where(seen, frames, -1))
    after = np.minimum.accumulate(np.where(seen, frames, len(frames))[::-1])[::-1]
    since = np.where(before >= 0, (frames - before) * dt_s, np.inf)
    until = np.where(after < len(frames), (after - frames) * dt_s, np.inf)
    if not both_sides:
        until = np.full(len(frames), np.inf)
    first, second = _bridge_weights(since / SKIN_MEMORY_S, until / SKIN_MEMORY_S)
    last = offset[np.maximum(before, 0)]
    following = offset[np.minimum(after, len(frames) - 1)]
    gap = ~seen
    expected[gap] = (first[:, None] * np.nan_to_num(last) + second[:, None] * np.nan_to_num(following))[gap]
    return expected


def _bridge_weights(since: Array, until: Array) -> tuple[Array, Array]:
    """Weights of both ends in the mean of an Ornstein–Uhlenbeck bridge; times in units of its memory.

    sinh(until) / sinh(since + until) and the like, written with decaying exponentials only; an end at infinity has
    no weight and leaves e^(−t) to the other.
    """
    fade_since, fade_until = np.exp(-since), np.exp(-until)
    whole = -np.expm1(-2.0 * (since + until))
    whole = np.where(whole > 0.0, whole, 1.0)
    first = fade_since * (1.0 - fade_until**2) / whole
    second = fade_until * (1.0 - fade_since**2) / whole
    return first, second
