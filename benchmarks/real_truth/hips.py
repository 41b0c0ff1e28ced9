"""Hip centres that a laboratory found from a movement of the hip, against those of our body."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel

WORDS = {"r": "right", "l": "left"}

METHODS = ("Gamage", "Score", "NM")
"""Ends of the points' names: Gamage 2002, SCoRE, and a nonlinear fit."""


def hip_distances(capture: Capture, found: Reconstruction) -> dict[str, tuple[float, float]]:
    """By side: mean distance of our hip centre from the mean of the methods, and theirs from it, mm.

    Empty for a capture without such points.

    Args:
        capture: The trial, whose points ``RightHipCenterScore`` and so on are hip centres.
        found: The reconstruction of it.
    """
    distances: dict[str, tuple[float, float]] = {}
    model = HumanModel.of(found.subject)
    for side in SIDES:
        names = tuple(f"{WORDS[side].capitalize()}HipCenter{method}" for method in METHODS)
        if not set(names) <= set(capture.markers.names):
            continue
        theirs = capture.markers.select(names).positions_m
        middle, joint = theirs.mean(axis=1), model.joint(f"{WORDS[side]}_thigh").joint_id
        ours = np.array([model.placements(q)[1][joint] for q in found.q])
        distances[side] = (_mean_mm(ours - middle), _mean_mm(theirs - middle[:, None]))
    return distances


def _mean_mm(vectors_m: Array) -> float:
    """Mean length of vectors, mm; NaN ones do not count."""
    return 1e3 * float(np.nanmean(np.linalg.norm(vectors_m, axis=-1)))
