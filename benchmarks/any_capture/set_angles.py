"""Angles of the legs and marker RMS that follow from an inferred marker set, against those of the right protocol."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.any_capture.marked import Known
from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.model.protocol import Protocol
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.protocol.inferred import InferredSet
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

MOST_FRAMES = 400
MASS_KG = 70.0
"""Of every person: the kinematic filter's angles do not depend on it."""

ANGLES = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")
MOST_DEG = {"own names": 2.0, "hidden names": 3.0}
MOST_FACTOR = 1.15
"""On the marker RMS."""


@dataclass(frozen=True)
class Compared:
    """An inferred set's reconstruction against the right protocol's.

    Attributes:
        worst_deg: Largest RMS difference of an angle, its mean removed.
        angle: Which angle that is.
        offset_deg: Largest mean difference.
        factor: Marker RMS over that of the right protocol.
    """

    worst_deg: float
    angle: str
    offset_deg: float
    factor: float

    def __str__(self) -> str:
        return f"{self.angle} {self.worst_deg:.1f}°, offset {self.offset_deg:.1f}°, RMS × {self.factor:.2f}"


FAILED = Compared(np.inf, "no reconstruction", np.inf, np.inf)


def reference(one: Known) -> Reconstruction:
    """The reconstruction by the right protocol."""
    return _followed(one.static, one.trial, one.protocol)


def compared(one: Known, inferred: InferredSet | None, truth: Reconstruction) -> Compared:
    """The reconstruction by an inferred set against the right one.

    Args:
        one: The capture.
        inferred: What was inferred; None, or a set that nothing can be scaled by, is infinitely far off.
        truth: The reconstruction by the right protocol.
    """
    if inferred is None:
        return FAILED
    static = None if one.static is None else inferred.captures[0]
    try:
        found = _followed(static, inferred.captures[-1], inferred.protocol)
    except MbkfError:
        return FAILED
    away = {name: np.rad2deg(found.angle(name) - truth.angle(name)) for name in ANGLES}
    spread = {name: _without_mean_rms(change) for name, change in away.items()}
    worst = max(spread, key=lambda name: np.nan_to_num(spread[name], nan=np.inf))
    offset = max(abs(float(np.nanmean(change))) for change in away.values())
    return Compared(spread[worst], worst, offset, marker_rms_m(found) / marker_rms_m(truth))


def marker_rms_m(found: Reconstruction) -> float:
    """RMS distance of the seen markers from the body's, m."""
    squared = ((found.measured_m - found.predicted_m) ** 2).sum(axis=2)
    return float(np.sqrt(np.nanmean(squared)))


def angle_rows(case: str, found: Mapping[str, Compared]) -> list[Check]:
    """The rows of a case; none where no capture was compared.

    Args:
        case: Key of :data:`MOST_DEG`.
        found: The comparisons by the capture's name.
    """
    if not found:
        return []
    worst = max(found, key=lambda name: found[name].worst_deg)
    loosest = max(found, key=lambda name: found[name].factor)
    told = f"{worst}, {found[worst].angle.replace('_', ' ')}"
    return [
        Check(
            f"marker sets, {case}: worst angle ({told}), RMS without the mean",
            found[worst].worst_deg,
            MOST_DEG[case],
            "<=",
            "°",
        ),
        Check(
            f"marker sets, {case}: worst marker RMS over the right set's ({loosest})",
            found[loosest].factor,
            MOST_FACTOR,
            "<=",
        ),
    ]


def _followed(static: Capture | None, trial: Capture, protocol: Protocol) -> Reconstruction:
    short = _best_seen(trial)
    subject = scale(static, [short], mass_kg=MASS_KG, protocol=protocol)
    return reconstruct(short, subject, settings=ReconstructSettings(filter="kinematic", smooth=True))


def _best_seen(trial: Capture) -> Capture:
    """The stretch in which most is seen, without plates, which such a filter does not follow."""
    markers = trial.markers
    seen = np.concatenate([[0], np.cumsum(markers.present.sum(axis=1))])
    last = max(markers.frames - MOST_FRAMES, 0)
    first = int((seen[MOST_FRAMES:] - seen[: last + 1]).argmax()) if last else 0
    cut = replace(markers, positions_m=markers.positions_m[first : first + MOST_FRAMES])
    return replace(trial, markers=cut, plates=())


def _without_mean_rms(change_deg: Array) -> float:
    return float(np.nanstd(change_deg))
