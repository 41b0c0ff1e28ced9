"""Joints beyond their range: by how much, and for how long, longer than an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.verdict.parts import part_of_segment

LASTING_S = 0.1
"""An excess counts that lasts this long in all, or a tenth of the trial where that is shorter."""

LEAST_DEG = 1.0
"""Smaller excesses are not listed."""

MOST_FRAMES = 400
"""Frames that are looked at, evenly spaced where there are more."""


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


def joints_beyond(model: HumanModel, q: Array, tracked: BoolArray, rate_hz: float) -> tuple[Beyond, ...]:
    """The joints that leave their ranges, the farthest first; each by its worst axis.

    Args:
        model: The body.
        q: (T, nq) configurations.
        tracked: (T,) frames in which the body was followed.
        rate_hz: Frame rate.
    """
    frames = np.flatnonzero(tracked & np.isfinite(q).all(axis=1))
    if not len(frames):
        return ()
    step = int(np.ceil(len(frames) / MOST_FRAMES))
    shown_s, frames = len(frames) / rate_hz, frames[::step]
    sensor = PostureSensor(model)
    turned = np.array([sensor.deviation(one)[0] for one in q[frames]])
    beyond = np.maximum(turned - model.limits[:, 1], model.limits[:, 0] - turned)
    beyond = np.rad2deg(np.where(np.isfinite(beyond), np.maximum(beyond, 0.0), 0.0))
    lasting = max(1, round(min(LASTING_S, 0.1 * shown_s) * rate_hz / step))
    # The excess that is passed for as long, whenever: the n-th largest.
    sizes = np.sort(beyond, axis=0)[-lasting]
    part = part_of_segment(model.description)
    found = []
    for name, joint in model.joints.items():
        if joint.kind == "free" or not (sizes[joint.v] > LEAST_DEG).any():
            continue
        axis = joint.v.start + int(np.argmax(sizes[joint.v]))
        seconds = float((beyond[:, axis] > LEAST_DEG).sum()) * step / rate_hz
        found.append(Beyond(part[name], name, float(sizes[axis]), seconds))
    return tuple(sorted(found, key=lambda one: -one.excess_deg))
