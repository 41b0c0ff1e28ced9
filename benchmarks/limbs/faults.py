"""Faults of limbs: poses that a filter is thrown into, and names that a capture exchanges from a frame on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.model.body import Body
from mbkf.model.limbs import Limb
from mbkf.sensors.limb_starts import next_joint, opposite_markers, turned_over
from mbkf.sensors.marker_sensor import MarkerSensor

POSES = ("turned over", "next segment turned over", "mirrored")
NAMES = ("segment's names exchanged", "sides exchanged")
HIDDEN = ("hidden, then turned over",)
KINDS = (*POSES, *NAMES, *HIDDEN)

HIDDEN_S = 0.4
"""A limb is hidden for so long before the filter is thrown into a wrong pose."""


def wrong_pose(kind: str, model: Body, limb: Limb, q: Array) -> Array:
    """(nq,) the pose with a limb as the fault has it.

    Args:
        kind: One of :data:`POSES`, or the last of :data:`KINDS`.
        model: The body.
        limb: The limb.
        q: (nq,) right pose.
    """
    first, after = limb.joints[0], next_joint(model, limb, limb.joints[0])
    assert after is not None
    if kind == "mirrored":
        return _mirrored(model, limb, q)
    if kind == "next segment turned over":
        last = next_joint(model, limb, after)
        return q if last is None else turned_over(model, q, after, last)
    return turned_over(model, q, first, after)


def _mirrored(model: Body, limb: Limb, q: Array) -> Array:
    """The first two segments turned by 180° about the line from the limb's root to the end of the second one."""
    first, after = limb.joints[0], next_joint(model, limb, limb.joints[0])
    assert after is not None
    last = next_joint(model, limb, after)
    assert last is not None
    axes, origins = model.placements(q)
    line = origins[last.joint_id] - origins[first.joint_id]
    line /= np.linalg.norm(line)
    step = np.zeros(model.nv)
    step[first.v] = np.pi * (axes[first.joint_id].T @ line)
    step[last.v] = np.pi * (axes[last.joint_id].T @ line)
    return model.integrate(q, step)


def exchanged(
    kind: str, sensor: MarkerSensor, limb: Limb, positions_m: Array, frame: int, rng: np.random.Generator
) -> Array:
    """(T, M, 3) markers whose names are exchanged from a frame on: of a segment two pairs, or those of both sides.

    Args:
        kind: One of :data:`NAMES`.
        sensor: The markers on the body.
        limb: The limb.
        positions_m: (T, M, 3) right positions.
        frame: First frame of the fault.
        rng: Chooses the pairs.
    """
    segments, order = np.array(sensor.segments), np.arange(len(sensor.segments))
    if kind == "sides exchanged":
        of_limb = {joint.segment for joint in limb.joints}
        pairs = [(a, b) for a, b in opposite_markers(sensor).items() if segments[a] in of_limb]
    else:
        counts = {joint.segment: np.flatnonzero(segments == joint.segment) for joint in limb.joints}
        largest = max(counts.values(), key=len)
        chosen = rng.permutation(largest)
        pairs = [(int(chosen[0]), int(chosen[1]))] if len(largest) >= 2 else []
        if len(largest) >= 5:
            pairs.append((int(chosen[2]), int(chosen[3])))
    for a, b in pairs:
        order[a], order[b] = b, a
    found = positions_m.copy()
    found[frame:] = found[frame:, order]
    return found


class ThrownFilter(TrackingFilter):
    """A filter that is thrown into a wrong pose in one frame.

    Attributes:
        thrown: The fault has happened.
    """

    def __init__(self, filter: TrackingFilter, kind: str, limb: Limb, frame: int) -> None:
        """Throws nothing yet.

        Args:
            filter: The filter.
            kind: The kind of fault.
            limb: The limb.
            frame: The first frame in which the fault may happen.
        """
        self.__dict__.update(filter.__dict__)
        self._kind, self._limb, self._frame, self.thrown = kind, limb, frame, False
        self._steps = 0

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """As the filter's."""
        found = super().start(recording, t, guess)
        return found if found is None else self._as_thrown(found, t)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """As the filter's."""
        return self._as_thrown(super().step(before, recording, t, prediction), t)

    def _as_thrown(self, found: Posterior, t: int) -> Posterior:
        if self.thrown or t < self._frame:
            return found
        self.thrown = True
        q = wrong_pose(self._kind, self.model, self._limb, found.q)
        state = replace(found.record.state, q=q)
        return found._replace(q=q, record=found.record._replace(state=state))
