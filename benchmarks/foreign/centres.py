"""True joint centres, from the exact places of markers: hips turn about a point, knees and ankles lie between markers.

OpenSim's hip is a ball joint. With exact rotations of pelvis and thigh its centre follows from places of markers of the
thigh by linear least squares, to the noise of these places over the square root of their number. At knee and ankle the
middle of both epicondyles and of both malleoli is the centre, as clinical protocols define it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.foreign.truth import TO_OURS, Truth
from mbkf.conventions import SIDES, Array
from mbkf.errors import InvalidInput

EVERY = 4
"""One frame of so many is used to find the hip."""

JOINTS = ("hip", "knee", "ankle")


class Landmarks(NamedTuple):
    """Names of one side's markers.

    Attributes:
        thigh: On the thigh.
        knee: Lateral and medial epicondyle.
        ankle: Lateral and medial malleolus.
    """

    thigh: tuple[str, ...]
    knee: tuple[str, str]
    ankle: tuple[str, str]


def _points(side: str) -> Landmarks:
    s = side.upper()
    return Landmarks(
        (f"{s}.TH1", f"{s}.TH2", f"{s}.TH3"), (f"{s}.Knee", f"{s}.MKnee"), (f"{s}.Ankle", f"{s}.MAnkle")
    )


def _underscores(side: str) -> Landmarks:
    s = {"r": "r", "l": "L"}[side]
    thigh = tuple(f"{s}_thigh{k}" for k in range(1, 5))
    return Landmarks(thigh, (f"{s}_knee", f"{s}_mknee"), (f"{s}_ankle", f"{s}_mankle"))


def landmarks(names: Sequence[str], side: str) -> Landmarks:
    """The markers of one side in the set that a capture uses.

    Args:
        names: The capture's markers.
        side: "r" or "l".

    Raises:
        InvalidInput: The set is not known here.
    """
    for named in (_points(side), _underscores(side)):
        if {*named.thigh, *named.knee, *named.ankle} <= set(names):
            return named
    raise InvalidInput("exact.trc holds markers of neither of the two known sets on thigh, knee and ankle")


def hip_in_pelvis(motions: Sequence[Truth], side: str) -> Array:
    """(3,) a hip's centre in OpenSim's pelvis, m, from all motions of one person.

    Args:
        motions: Motions of the person.
        side: "r" or "l".
    """
    rows, targets = [], []
    for truth in motions:
        markers = landmarks(truth.exact.names, side).thigh
        turned, origin = (part[::EVERY] for part in truth.pelvis())
        thigh = turned @ truth.thigh_in_pelvis(side)[::EVERY]
        for k, name in enumerate(markers):
            row = np.zeros((len(turned), 3, 3 + 3 * len(markers)))
            row[:, :, :3] = turned
            row[:, :, 3 + 3 * k : 6 + 3 * k] = thigh
            rows.append(row)
            targets.append(_place(truth, name)[::EVERY] @ TO_OURS - origin)
    A, b = np.concatenate(rows), np.concatenate(targets).ravel()
    A = A.reshape(len(b), -1)
    known = np.isfinite(b)
    return np.asarray(np.linalg.lstsq(A[known], b[known], rcond=None)[0][:3])


def true_centres(truth: Truth, hips: dict[str, Array]) -> dict[tuple[str, str], Array]:
    """(T, 3) centres by joint and side in our axes, m.

    Args:
        truth: A motion.
        hips: The hips' centres in the pelvis by side.
    """
    turned, origin = truth.pelvis()
    found = {}
    for side in SIDES:
        named = landmarks(truth.exact.names, side)
        found["hip", side] = (origin + turned @ hips[side]) @ TO_OURS.T
        for joint, pair in (("knee", named.knee), ("ankle", named.ankle)):
            found[joint, side] = 0.5 * (_place(truth, pair[0]) + _place(truth, pair[1]))
    return found


def _place(truth: Truth, name: str) -> Array:
    """(T, 3) exact places of a marker in our axes, m."""
    return truth.exact.positions_m[:, truth.exact.names.index(name)]
