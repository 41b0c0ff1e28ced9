"""Markers hidden in streaks, the same for all tools: how far from their places each tool expects them.

Peers' markers are corrected on the whole trial, hidden samples included, and the best of their settings counts; ours
are corrected on what is shown, with default settings.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.losses import FRACTIONS, Occluded, occluded, occlusion_errors
from benchmarks.dynamic.methods import pooled
from benchmarks.peers import biorbd_tool
from benchmarks.peers.results import CAUSAL, NOISES, SMOOTH, Results, follow_by_opensim
from benchmarks.references import rms
from mbkf.conventions import Array, BoolArray

RATIO = 0.7
_MM = 1e3


def hidden_rows(found: Results, seeds: Sequence[int], bounded: bool) -> list[Check]:
    """Errors at hidden samples, and ours over the better peer's.

    Args:
        found: What the tools make of the whole capture.
        seeds: Random seeds of the streaks.
        bounded: Whether the ratios have bounds.
    """
    rows: list[Check] = []
    person = found.shared.person
    for fraction in FRACTIONS:
        cases = [occluded(person, fraction, seed) for seed in seeds]
        ours = {
            method.label: pooled(occlusion_errors(case, method).hidden_mm for case in cases)
            for method in (CAUSAL, SMOOTH)
        }
        errors = [peer_errors(found, case) for case in cases]
        theirs = {name: pooled(one[name] for one in errors) for name in errors[0]}
        label = f"{found.shared.name}, {100 * fraction:.0f} % hidden"
        rows += [
            information(f"{label}: {name}", value, "mm")
            for name, value in ({f"mbkf {kind}": value for kind, value in ours.items()} | theirs).items()
        ]
        better = min(theirs.values())
        rows += [
            Check(f"{label}: mbkf {kind} / better peer", value / better, RATIO if bounded else np.inf, "<=")
            for kind, value in ours.items()
        ]
    return rows


def peer_errors(found: Results, case: Occluded) -> dict[str, float]:
    """RMS distance in mm of the peers' markers from the places of hidden ones, by tool and its settings.

    Args:
        found: What the tools make of the whole capture.
        case: The capture with hidden streaks; its markers stand in the order of the shared ones.
    """
    own = found.shared
    shown_m, errors = masked(own.lab_m, case.hidden), dict[str, float]()
    for toes, body in found.bodies.items():
        markers_m = follow_by_opensim(body, own, shown_m).markers_m
        errors[f"OpenSim{toes}"] = error_mm(markers_m, own.lab_m, case.hidden)
        for kind, noise in NOISES.items():
            motion = biorbd_tool.follow(body.body, shown_m, own.rate_hz, noise)
            errors[f"biorbd{toes}{kind}"] = error_mm(motion.markers_m, own.lab_m, case.hidden)
    return errors


def masked(lab_m: Array, hidden: BoolArray) -> Array:
    """(T, M, 3) positions with NaN where hidden (T, M)."""
    return np.where(hidden[:, :, None], np.nan, lab_m)


def error_mm(found_m: Array, true_m: Array, judged: BoolArray) -> float:
    """RMS distance over the judged samples, mm.

    Args:
        found_m: (T, M, 3) positions, m.
        true_m: (T, M, 3) positions, m.
        judged: (T, M) samples that count.
    """
    return rms(_MM * np.linalg.norm(found_m - true_m, axis=2)[judged])
