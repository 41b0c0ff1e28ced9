"""Which markers of a frame to believe: an innovation gate per marker."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.markers import MarkerReading, MarkerSensor

STRAYED_M = 0.10
"""Where more than half of the markers lie so far off their prediction, the body has jumped or it is another one, and
the filter has to start anew. Fast limbs are mispredicted by a third of that, most markers by a tenth."""

_NONE = np.zeros(0, dtype=np.intp)


class GateSettings(Protocol):
    """What a filter's settings say about markers that misbehave."""

    @property
    def gate(self) -> float:
        """Squared Mahalanobis distance (3 readings) above which a marker is not believed."""

    @property
    def gate_radius_m(self) -> float:
        """Distance below which no marker is refused, m."""


class Sight:
    """Which dofs belong to segments that are out of sight."""

    def __init__(self, sensor: MarkerSensor, held: BoolArray) -> None:
        joints = np.empty(sensor.model.nv, dtype=int)
        for joint in sensor.model.joints.values():
            joints[joint.v] = joint.joint_id
        self._on_segment = (sensor.joint_ids[:, None] == joints) & ~held
        self._watched = self._on_segment.any(axis=0)
        # Markers come and go seldom, so the last answer is kept.
        self._asked, self._unseen = b"", _NONE

    def carriers(self, markers: BoolArray) -> NDArray[np.intp]:
        """Dofs of the joints whose segments carry any of the ``markers`` (M,)."""
        return np.flatnonzero(markers @ self._on_segment)

    def unseen(self, trusted: BoolArray) -> NDArray[np.intp]:
        """Dofs whose segment carries markers none of which is ``trusted`` (M,) now."""
        asked = trusted.tobytes()
        if asked != self._asked:
            self._asked = asked
            self._unseen = np.flatnonzero(self._watched & ~(trusted @ self._on_segment))
        return self._unseen


class Belief(NamedTuple):
    """Markers of a frame (M,): those ``seen``, those of them ``trusted``, and those of segments found elsewhere.

    ``displaced`` markers, all that are seen of a segment, lie far from where it was expected, so that the state is
    wrong there and not they; None where there are none. ``strayed``: most markers are far from the state.
    """

    seen: BoolArray
    trusted: BoolArray
    displaced: BoolArray | None
    strayed: bool = False


def judged(
    innovation_m: Array,
    reading: MarkerReading,
    covariance: Array,
    noise_m: Array,
    settings: GateSettings,
) -> Belief:
    """Seen and believable markers: those inside their gate, yᵀ S⁻¹ y ≤ gate with S = H P Hᵀ + R, or near enough.

    When more than half of the markers fall outside, the state is wrong and not the markers, and all are believed.
    The Jacobian is asked for only of markers that lie far off.

    Args:
        innovation_m: (M, 3) measured minus predicted, NaN where missing.
        reading: The prediction.
        covariance: (nv, nv) predicted covariance P of the configuration.
        noise_m: (M,) marker noise.
        settings: Gate and radius.
    """
    squared = np.einsum("ij,ij->i", innovation_m, innovation_m)
    near = squared <= settings.gate_radius_m**2
    seen = squared == squared  # noqa: PLR0124, a missing marker's is NaN
    if np.count_nonzero(near) == np.count_nonzero(seen):
        return Belief(seen, near, None)
    strayed = bool(2 * np.count_nonzero(squared > STRAYED_M**2) > np.count_nonzero(seen))
    far = seen & ~near
    distance = _distance(innovation_m[far], reading.only(far).jacobian, covariance, noise_m[far])
    trusted = _with_far(seen, near, far, distance, settings.gate)
    if trusted.all():
        return Belief(seen, trusted, None, strayed)
    displaced = _whole_segments(seen, trusted, reading.moves)
    return Belief(seen, trusted | displaced, displaced if displaced.any() else None, strayed)


def _whole_segments(seen: BoolArray, trusted: BoolArray, moves: Array) -> BoolArray:
    """(M,) markers of segments all of whose seen markers, two or more, lie far off: then the limb is, not they."""
    shared = moves @ moves.T
    own = np.diag(shared)
    same = (shared == own) & (shared == own[:, None])
    lost = (same & seen).sum(axis=1) >= 2
    return seen & lost & ~(same & trusted).any(axis=1)


def _distance(y: Array, H: Array, covariance: Array, noise_m: Array) -> Array:
    """(m,) yᵀ S⁻¹ y of innovations (m, 3) with Jacobians (m, 3, nv)."""
    S = (H @ covariance) @ H.transpose(0, 2, 1)
    S[:, np.arange(3), np.arange(3)] += noise_m[:, None] ** 2
    found: Array = (y * np.linalg.solve(S, y[:, :, None])[:, :, 0]).sum(axis=1)
    return found


def _with_far(seen: BoolArray, near: BoolArray, far: BoolArray, distance: Array, gate: float) -> BoolArray:
    """Near markers and those far ones inside the gate; all seen ones where these are less than half."""
    inside = near.copy()
    inside[far] = distance <= gate
    mostly_outside = inside.sum() < 0.5 * seen.sum()
    return seen if mostly_outside else inside
