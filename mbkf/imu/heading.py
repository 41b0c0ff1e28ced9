"""Headings of a chain of segments held together by its joints, so that none drifts away on its own.

Joints of the legs hardly turn about the vertical: seen from above, the side-to-side axes of neighbouring segments stay
within some degrees of each other. Each joint is read so, with its own spread; headings drift slowly between.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import multiply, rotate
from mbkf.model.clinical_table import ClinicalJoint

ARBITRARY_SD_RAD = 3.0
"""Spread of a heading of which nothing is known."""


@dataclass(frozen=True)
class HeadingSettings:
    """Drift of headings, and strength of the joints' constraints.

    Attributes:
        walk_rad: Random walk of a segment's heading error, rad/√s: gyroscope drift or a disturbed field.
        memory_s: Joint readings are independent after this time.
        start_sd_rad: Spread of the heading errors at the start.
        spread_scale: Factor on the joints' spreads.
    """

    walk_rad: float = 0.01
    memory_s: float = 1.0
    start_sd_rad: float = 0.2
    spread_scale: float = 1.0


def held_headings(
    segments: Sequence[str],
    orientation: Array,
    dt_s: float,
    joints: Iterable[ClinicalJoint],
    settings: HeadingSettings | None = None,
    arbitrary: Collection[int] = (),
) -> Array:
    """Corrections (T, S) of headings, rad, to be added to those of segments; the first segment's is 0.

    A Kalman filter with backward smoother over all joints at once.

    Args:
        segments: S names; the first one is the chain's root.
        orientation: (T, S, 4) segment → world, z up.
        dt_s: Time between samples.
        joints: The body's joints; those with a heading_sd_deg between two of the segments hold their headings.
        settings: Its weights.
        arbitrary: Segments whose heading is not known at the start: their sensors' fields are left out.
    """
    s = settings or HeadingSettings()
    holding = [
        (segments.index(joint.proximal), segments.index(joint.distal), joint.heading_sd_deg)
        for joint in joints
        if joint.heading_sd_deg is not None and {joint.proximal, joint.distal} <= set(segments)
    ]
    count, n = len(orientation), len(segments)
    side = rotate(orientation, np.array([0.0, 1.0, 0.0]))
    level = np.hypot(side[..., 0], side[..., 1])
    heading = np.unwrap(np.arctan2(side[..., 1], side[..., 0]), axis=0)
    H = np.zeros((len(holding), n))
    for row, (a, b, _) in enumerate(holding):
        H[row, a], H[row, b] = -1.0, 1.0
    sd = np.radians([spread for _, _, spread in holding]) * s.spread_scale
    apart = heading @ H.T
    apart -= 2.0 * np.pi * np.round(np.median(apart, axis=0) / (2.0 * np.pi))
    # Headings are relative to that of one sensor, the first whose heading is known.
    known_one = next((k for k in range(n) if k not in arbitrary), 0)
    P = np.diag([ARBITRARY_SD_RAD**2 if k in arbitrary else s.start_sd_rad**2 for k in range(n)])
    P[known_one, known_one] = 1e-12
    Q = s.walk_rad**2 * dt_s * np.eye(n)
    Q[known_one, known_one] = 0.0
    above, below = [one[0] for one in holding], [one[1] for one in holding]
    # A side axis near the vertical has no heading.
    weak = 1.0 / np.maximum(np.minimum(level[:, above], level[:, below]), 0.1) ** 4
    noise, known = sd**2 * weak * (s.memory_s / dt_s), np.isfinite(apart)
    diagonal = np.diag_indices(len(holding))
    x, means, covariances = np.zeros(n), np.empty((count, n)), np.empty((count, n, n))
    for t in range(count):
        P = P + Q
        HP = H @ P
        S = HP @ H.T
        S[diagonal] += noise[t]
        K = np.linalg.solve(S, HP).T
        x = x + K @ np.where(known[t], -apart[t] - H @ x, 0.0)
        P = P - K @ HP
        means[t], covariances[t] = x, P
    back = np.linalg.solve(covariances[:-1] + Q + 1e-15 * np.eye(n), covariances[:-1]).swapaxes(1, 2)
    for t in range(count - 2, -1, -1):
        means[t] += back[t] @ (means[t + 1] - means[t])
    return means - means[:, :1]


def turned(orientation: Array, heading: Array) -> Array:
    """(T, S, 4) orientations turned about the vertical by (T, S) rad."""
    zero = np.zeros_like(heading)
    return multiply(
        np.stack([zero, zero, np.sin(0.5 * heading), np.cos(0.5 * heading)], axis=-1), orientation
    )
