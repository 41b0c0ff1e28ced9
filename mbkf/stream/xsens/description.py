"""A stream of MVN as its first second shows it: type, rate, steps of the count, vertical axis, unit and segments."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.frames import exponential, matrix_quaternion
from mbkf.io.axes import rotation_to_world
from mbkf.stream.source import StreamDescription
from mbkf.stream.xsens.joining import MvnSample
from mbkf.stream.xsens.packets import POSES, SEGMENTS

ARMS = ("upper_arm", "forearm", "hand")

RATES_HZ = (5.0, 1000.0)

ODD_HZ = 0.05
"""MVN's rates are whole numbers; one that is measured further from a whole number is kept as measured."""

FARTHEST_HEAD = 5.0
"""A head further from the pelvis than this, in the stream's unit, is not so far in metres: the unit is centimetres."""

UPRIGHT = 0.8
"""Share of the way from pelvis to head along y from which on y is taken to point up."""


@dataclass(frozen=True)
class MvnDescription:
    """A stream's description.

    Attributes:
        stream: Its description; sensors are named after their segments.
        ids: (S,) segments' IDs.
        kind: Type of the data.
        step: MVN's count grows by so much from frame to frame.
        metres: Size of its unit of length, m.
        rotation: (3, 3) from its axes to the world's.
        turn: (4,) the same as a quaternion.
        laid: (S, 4) segment's axes that are x forward, y left, z up in the neutral posture → MVN's, so in the T-pose.
        remarks: Kinds and sentences on unit and axes.
    """

    stream: StreamDescription
    ids: tuple[int, ...]
    kind: int
    step: int
    metres: float
    rotation: Array
    turn: Array
    laid: Array
    remarks: tuple[tuple[str, str], ...]


def describe(samples: Sequence[MvnSample], kind: int, up: str | None) -> MvnDescription:
    """The description that a second of samples gives.

    Args:
        samples: Samples of one type and person, at least two.
        kind: Their type.
        up: Axis that points up; None for the one that the posture shows.

    Raises:
        InvalidInput: The rate is not possible, or no segment of a body is among them.
        UnknownName: The axis does not exist.
    """
    step, rate_hz = _rate(samples)
    seen = {int(one) for sample in samples for one in sample.ids}
    ids = tuple(one for one in SEGMENTS if one in seen)
    if not ids:
        raise InvalidInput("Xsens: MVN streams no segment of a person; switch on the character's own data")
    metres, found_up, remarks = 1.0, "z", list[tuple[str, str]]()
    if kind == POSES:
        trunk = _trunk(samples)
        if trunk is not None and np.linalg.norm(trunk) > FARTHEST_HEAD:
            metres = 0.01
            remarks.append(("unit", "MVN's positions are taken as centimetres, by the length of the trunk"))
        if trunk is not None and trunk[1] > UPRIGHT * np.linalg.norm(trunk):
            found_up = "y"
            if up is None:
                remarks.append(("axes", "MVN's y axis is taken to point up, as from pelvis to head"))
    rotation = rotation_to_world(up or found_up)
    stream = StreamDescription("xsens", (), rate_hz, sensors=tuple(SEGMENTS[one] for one in ids))
    laid = np.array([_laid(SEGMENTS[one]) for one in ids])
    turn = matrix_quaternion(rotation)
    return MvnDescription(stream, ids, kind, step, metres, rotation, turn, laid, tuple(remarks))


def _laid(segment: str) -> Array:
    """(4,) MVN's axes → the segment's own: arms, which lie along y in the T-pose, hang in the neutral posture."""
    if not segment.endswith(ARMS):
        return np.array([0.0, 0.0, 0.0, 1.0])
    return exponential(np.array([-0.5 * np.pi if segment.startswith("right") else 0.5 * np.pi, 0.0, 0.0]))


def _rate(samples: Sequence[MvnSample]) -> tuple[int, float]:
    """Step of the count, and frames per second by MVN's clock, or by arrival where that stands still."""
    numbers = np.array([one.number for one in samples], dtype=float)
    steps = Counter(int(one) for one in np.diff(np.sort(numbers)) if one > 0)
    step = steps.most_common(1)[0][0] if steps else 1
    frames = (numbers - numbers[0]) / step
    for times in ([one.time_ms / 1e3 for one in samples], [one.arrival_s for one in samples]):
        times_s = np.array(times) - times[0]
        if not np.ptp(frames) or not np.ptp(times_s):
            continue
        slope_s = float(np.polyfit(frames, times_s, 1)[0])
        if not 1.0 / RATES_HZ[1] <= slope_s <= 1.0 / RATES_HZ[0]:
            continue
        rate_hz, whole = 1.0 / slope_s, round(1.0 / slope_s)
        return step, float(whole) if abs(rate_hz - whole) < ODD_HZ else rate_hz
    raise InvalidInput(
        "Xsens: MVN's clock shows no possible frame rate; start the live view or the playback in MVN"
    )


def _trunk(samples: Sequence[MvnSample]) -> Array | None:
    """(3,) mean way from pelvis to head; None where one of both is not sent."""
    ways = []
    for one in samples:
        places = {int(k): row[:3] for k, row in zip(one.ids, one.values, strict=True) if k in (1, 7)}
        if len(places) == 2:
            ways.append(places[7] - places[1])
    found = np.mean(ways, axis=0) if ways else None
    return None if found is None or not np.isfinite(found).all() else found
