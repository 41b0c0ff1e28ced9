"""Gating of a frame's markers by the Mahalanobis distance of each marker's innovation.

A marker passes where yᵀ S⁻¹ y ≤ gate with S = H P⁻ Hᵀ + R, or where it lies within a radius of its prediction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.block import NO_DOFS
from mbkf.sensors.marker_sensor import MarkerReading, MarkerSensor

TRACK_LOSS_M = 0.10
"""The track is lost if more than half of the markers lie farther than this from their prediction: the body has jumped,
or it is another one. Fast limbs are mispredicted by a third of that, most markers by a tenth."""


class ObservedDofs:
    """Dofs that the used markers leave unobserved."""

    def __init__(self, sensor: MarkerSensor, unobservable: BoolArray) -> None:
        """Args: the markers on the body, and the dofs (nv,) that move no marker of the capture."""
        joints = np.empty(sensor.model.nv, dtype=int)
        for joint in sensor.model.joints.values():
            joints[joint.v] = joint.joint_id
        self._on_segment = (sensor.joint_ids[:, None] == joints) & ~unobservable
        self._watched = self._on_segment.any(axis=0)
        # Markers come and go seldom, so the last answer is kept.
        self._asked, self._answer = b"", NO_DOFS

    def carriers(self, markers: BoolArray) -> NDArray[np.intp]:
        """Dofs of the joints whose segments carry any of the ``markers`` (M,)."""
        return np.flatnonzero(markers @ self._on_segment)

    def carried_by(self, dofs: NDArray[np.intp]) -> BoolArray:
        """(M,) markers on segments whose joints have any of the ``dofs``."""
        found: BoolArray = self._on_segment[:, dofs].any(axis=1)
        return found

    def unmarked(self, trusted: BoolArray) -> NDArray[np.intp]:
        """Dofs whose segment carries markers but no ``trusted`` one (M,)."""
        asked = trusted.tobytes()
        if asked != self._asked:
            self._asked = asked
            self._answer = np.flatnonzero(self._watched & ~(trusted @ self._on_segment))
        return self._answer


class Gated(NamedTuple):
    """Sorted markers of a frame.

    Attributes:
        seen: (M,) markers seen.
        trusted: (M,) markers used.
        squared_m2: (M,) squared length of the innovation of trusted markers, 0 of others.
        displaced: (M,) markers of segments of which all seen markers lie far from their prediction, so that the state
            is wrong there and not they; None without one.
        lost: True if most markers lie far from their prediction.
    """

    seen: BoolArray
    trusted: BoolArray
    squared_m2: Array
    displaced: BoolArray | None
    lost: bool = False


def gated(
    innovation_m: Array,
    reading: MarkerReading,
    covariance: Array,
    noise_m: Array,
    gate: float,
    radius_m: float,
    noise_scale: float = 1.0,
) -> Gated:
    """Sorts the markers of a frame.

    If more than half of the markers fall outside, the state is wrong and not the markers, and all are used.
    The Jacobian is computed only of markers outside the gate of an exact prediction.

    Args:
        innovation_m: (M, 3) measured minus predicted, NaN where missing.
        reading: The prediction.
        covariance: (nv, nv) predicted covariance P⁻ of the configuration.
        noise_m: (M,) marker noise.
        gate: Largest squared Mahalanobis distance (3 readings).
        radius_m: Distance below which every marker is used.
        noise_scale: Factor on the square of the noise.
    """
    squared = np.vecdot(innovation_m, innovation_m)
    near = squared <= radius_m**2
    seen = squared == squared  # noqa: PLR0124, a missing marker's is NaN
    if near.tobytes() == seen.tobytes():
        return Gated(seen, seen, np.where(seen, squared, 0.0), None)
    lost = bool(2 * np.count_nonzero(squared > TRACK_LOSS_M**2) > np.count_nonzero(seen))
    variance = noise_scale * noise_m**2
    # S is no less than R, so that what R alone lets pass passes.
    near |= squared <= gate * variance
    far = seen & ~near
    if not far.any():
        return Gated(seen, seen, np.where(seen, squared, 0.0), None, lost)
    distance = _distance(innovation_m[far], reading.only(far).jacobian, covariance, variance[far])
    trusted, displaced = _with_far(seen, near, far, distance, gate), None
    if trusted.tobytes() != seen.tobytes():
        displaced = _whole_segments(seen, trusted, reading.moves)
        trusted, displaced = trusted | displaced, displaced if displaced.any() else None
    return Gated(seen, trusted, np.where(trusted, squared, 0.0), displaced, lost)


def _whole_segments(seen: BoolArray, trusted: BoolArray, moves: Array) -> BoolArray:
    """(M,) markers of segments all of whose seen markers, two or more, lie far off: the limb is displaced."""
    shared = moves @ moves.T
    own = np.diag(shared)
    same = (shared == own) & (shared == own[:, None])
    lost = (same & seen).sum(axis=1) >= 2
    return seen & lost & ~(same & trusted).any(axis=1)


def _distance(y: Array, H: Array, covariance: Array, variance_m2: Array) -> Array:
    """(m,) yᵀ S⁻¹ y of innovations (m, 3) by Jacobians (m, 3, nv), covariance P⁻ (nv, nv), noise variances (m,)."""
    S = (H @ covariance) @ H.transpose(0, 2, 1)
    S[:, np.arange(3), np.arange(3)] += variance_m2[:, None]
    try:
        found: Array = (y * np.linalg.solve(S, y[:, :, None])[:, :, 0]).sum(axis=1)
    except np.linalg.LinAlgError:
        # P⁻ of a lost track may be so large that S no longer holds R: every marker then passes.
        return np.zeros(len(y))
    return found


def _with_far(seen: BoolArray, near: BoolArray, far: BoolArray, distance: Array, gate: float) -> BoolArray:
    """Near markers and far ones inside the gate; all seen ones if these are less than half."""
    inside = near.copy()
    inside[far] = distance <= gate
    mostly_outside = inside.sum() < 0.5 * seen.sum()
    return seen if mostly_outside else inside
