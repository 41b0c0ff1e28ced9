"""Joints beyond their range: by how much, and for how long, longer than an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.verdict.parts import part_of_segment

LASTING_S = 0.1
"""An excess counts that lasts this long in all, or a tenth of the trial where that is shorter."""

LEAST_DEG = 1.0
"""Smaller excesses are not listed."""

SAMPLED_HZ = 100.0
"""About so many frames in a second are looked at."""


@dataclass(frozen=True)
class Beyond:
    """A joint beyond its range.

    Attributes:
        part: The part that the joint belongs to.
        joint: Name of its distal segment.
        excess_deg: Excess that is reached or passed for :data:`LASTING_S` in all.
        seconds: Time beyond the range in all.
    """

    part: str
    joint: str
    excess_deg: float
    seconds: float


class RangeSums:
    """The largest excesses of each joint over frames that come in blocks, in order."""

    def __init__(self, model: Body, rate_hz: float) -> None:
        """Sums without a frame.

        Args:
            model: The body.
            rate_hz: Frame rate.
        """
        self._model, self._sensor = model, PostureSensor(model)
        self._every = max(1, round(rate_hz / SAMPLED_HZ))
        self._sampled_hz = rate_hz / self._every
        most = max(1, round(LASTING_S * self._sampled_hz))
        self._largest = np.zeros((most, model.nv))
        self._beyond = np.zeros(model.nv, dtype=np.int64)
        self._frames = self._samples = 0

    def add(self, q: Array) -> None:
        """Adds the next frames in which the body is followed.

        Args:
            q: (n, nq) configurations.
        """
        q = q[np.isfinite(q).all(axis=1)]
        chosen = q[-self._frames % self._every :: self._every]
        self._frames += len(q)
        if not len(chosen):
            return
        self._samples += len(chosen)
        turned = np.array([self._sensor.deviation(one)[0] for one in chosen])
        limits = self._model.limits
        beyond = np.maximum(turned - limits[:, 1], limits[:, 0] - turned)
        beyond = np.rad2deg(np.where(np.isfinite(beyond), np.maximum(beyond, 0.0), 0.0))
        self._beyond += (beyond > LEAST_DEG).sum(axis=0)
        if (beyond > self._largest[0]).any():
            self._largest = np.sort(np.vstack([self._largest, beyond]), axis=0)[-len(self._largest) :]

    def joints(self) -> tuple[Beyond, ...]:
        """The joints that leave their ranges, the farthest first; each by its worst axis."""
        shown_s = self._samples / self._sampled_hz
        lasting = max(1, round(min(LASTING_S, 0.1 * shown_s) * self._sampled_hz))
        # The excess that is passed for as long, whenever: the n-th largest.
        sizes = self._largest[-lasting]
        part = part_of_segment(self._model.description)
        found = []
        for name, joint in self._model.joints.items():
            if joint.kind == "free" or not (sizes[joint.v] > LEAST_DEG).any():
                continue
            axis = joint.v.start + int(np.argmax(sizes[joint.v]))
            found.append(
                Beyond(part[name], name, float(sizes[axis]), float(self._beyond[axis]) / self._sampled_hz)
            )
        return tuple(sorted(found, key=lambda one: -one.excess_deg))
