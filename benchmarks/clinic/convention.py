"""The clinical convention against the curves of Plug-in Gait that the files of five walks hold.

Zero: the mean difference of a curve. Sign: the correlation of ours with theirs, where theirs moves and both go together
or against each other. Plug-in Gait's axes were set on HC032A, HC044A and cgm24 (``benchmarks angles``), the unit of a
file's angles on functional_walk, the order of the foot's progression on functional_walk, gaitalytics_walk and HC032A.
The movement from which a sign counts, 1°, was set after all five walks had been seen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.angles.archives import ARCHIVES, Archive
from benchmarks.checks import Check, information
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.study.session.cycles import ANGLE, TORQUE, Key
from mbkf.trial.gait.convention import BY_CLINIC, BY_MODEL, FOOT_PROGRESSION, TRUNK, Convention
from mbkf.trial.gait.curves import SideCurve, side_views
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

MOST_OFFSET_DEG = {"sagittal": 4.0, "frontal": 6.0, "transverse": 6.0}

WALKS = (
    *ARCHIVES,
    Archive("functional", "functional_walk", "FunctionalWalk.c3d", "FunctionalStatic.c3d", 60.0),
    Archive("gaitalytics", "gaitalytics_walk", "overground_fullbody_4plates.c3d", None, 63.6),
)

ANGLES = (
    ("Pelvis", 0, "pelvis_tilt", "sagittal"),
    ("Pelvis", 1, "pelvis_list", "frontal"),
    ("Pelvis", 2, "pelvis_rotation", "transverse"),
    ("Hip", 0, "hip_flexion", "sagittal"),
    ("Hip", 1, "hip_adduction", "frontal"),
    ("Hip", 2, "hip_rotation", "transverse"),
    ("Knee", 0, "knee_angle", "sagittal"),
    ("Knee", 1, "knee_adduction", "frontal"),
    ("Knee", 2, "knee_rotation", "transverse"),
    ("Ankle", 0, "ankle_angle", "sagittal"),
    ("Ankle", 2, "ankle_rotation", "transverse"),
    ("FootProgress", 2, FOOT_PROGRESSION, "transverse"),
)
"""Plug-in Gait's output without its side, its column, our curve, and the plane."""

MOMENTS = (
    ("Hip", 0, "hip_flexion"),
    ("Hip", 1, "hip_adduction"),
    ("Knee", 0, "knee_angle"),
    ("Knee", 1, "knee_adduction"),
    ("Ankle", 0, "ankle_angle"),
)

LEAST_MOVED_DEG, LEAST_MOVED_NM_KG = 1.0, 0.2
"""Standard deviation of Plug-in Gait's curve from which its sign can be judged; 1° was set on all five walks."""

LEAST_CORRELATION = 0.5
"""Without sign; of curves that are less alike, noise hides it."""


@dataclass(frozen=True)
class Compared:
    """A curve against Plug-in Gait's; NaN without one.

    Attributes:
        offset: Mean difference.
        rms: Of the difference less its mean.
        correlation: Of both curves.
        moved: Standard deviation of Plug-in Gait's curve.
    """

    offset: float
    rms: float
    correlation: float
    moved: float

    @classmethod
    def of(cls, ours: Array, theirs: Array) -> Compared:
        """Of (T,) values."""
        known = np.isfinite(ours) & np.isfinite(theirs)
        if known.sum() < 2:
            return cls(np.nan, np.nan, np.nan, 0.0)
        x, y = theirs[known] - theirs[known].mean(), ours[known] - ours[known].mean()
        sizes = float(np.sqrt((x @ x) * (y @ y)))
        correlation = float(x @ y) / sizes if sizes > 0.0 else np.nan
        return cls(float((ours - theirs)[known].mean()), float((y - x).std()), correlation, float(x.std()))

    def sign_shows(self, least: float) -> bool:
        """True where Plug-in Gait's curve moves enough and correlates with ours, of either sign."""
        return self.moved > least and abs(self.correlation) > LEAST_CORRELATION


def convention_rows(data: Path) -> list[Check]:
    """The rows of all walks.

    Args:
        data: Folder of the reference captures.
    """
    return [row for walk in WALKS for row in _rows(walk, data)]


def _rows(walk: Archive, data: Path) -> Iterator[Check]:
    capture, found = followed(walk, data)
    clinical, model = (_compared(capture, found, one) for one in (BY_CLINIC, BY_MODEL))
    for n, (output, _, _, plane) in enumerate(ANGLES):
        both = clinical[n]
        name = f"{walk.name}, {output.lower()}, {plane} plane"
        offset = max(abs(one.offset) for one in both)
        yield Check(f"{name}: mean difference", offset, MOST_OFFSET_DEG[plane], "<=", "°")
        yield information(f"{name}: RMS without the mean", max(one.rms for one in both), "°")
        yield from _sign(name, both, LEAST_MOVED_DEG)
    yield from _moment_signs(walk.name, capture, found)
    seen = [one for row in model for one in row if one.sign_shows(LEAST_MOVED_DEG)]
    turned = sum(one.correlation < 0.0 for one in seen)
    yield information(f"{walk.name}, in the body's own convention: signs reversed", turned)
    for plane in MOST_OFFSET_DEG:
        of_plane = [one for row, (*_, p) in zip(model, ANGLES, strict=True) if p == plane for one in row]
        most = np.nanmax([abs(one.offset) for one in of_plane])
        name = f"{walk.name}, in the body's own convention, {plane} plane: largest mean difference"
        yield information(name, float(most), "°")
    yield from _trunk(walk.name, capture, found)


def _compared(capture: Capture, found: Reconstruction, convention: Convention) -> list[list[Compared]]:
    """Right and left of each of :data:`ANGLES`."""
    sides = [_curves(found, side, convention) for side in range(2)]
    return [
        [
            Compared.of(_ours(curves, ANGLE, key), column_of(capture, f"{side}{output}Angles", column))
            for side, curves in zip("RL", sides, strict=True)
        ]
        for output, column, key, _ in ANGLES
    ]


def _sign(name: str, both: list[Compared], least: float) -> Iterator[Check]:
    """Sides whose sign is reversed, where one's sign shows, and the least correlation."""
    seen = [one.correlation for one in both if one.sign_shows(least)]
    if seen:
        yield Check(f"{name}: signs reversed", sum(one < 0.0 for one in seen), 0, "<=")
        yield information(f"{name}: least correlation", min(seen))


def _moment_signs(walk: str, capture: Capture, found: Reconstruction) -> Iterator[Check]:
    sides = [_curves(found, side, BY_CLINIC) for side in range(2)]
    for output, column, key in MOMENTS:
        both = [
            Compared.of(
                _ours(curves, TORQUE, key) / found.subject.mass_kg,
                1e-3 * column_of(capture, f"{side}{output}Moment", column),
            )
            for side, curves in zip("RL", sides, strict=True)
        ]
        plane = ("sagittal", "frontal")[column]
        yield from _sign(f"{walk}, {output.lower()} moment, {plane} plane", both, LEAST_MOVED_NM_KG)


def _trunk(walk: str, capture: Capture, found: Reconstruction) -> Iterator[Check]:
    """Attitude of the trunk, in the axes that C7, T10, CLAV and STRN define; none of a walk without these outputs."""
    sides = [_curves(found, side, BY_CLINIC) for side in range(2)]
    for (column, name), plane in zip(enumerate(TRUNK), MOST_OFFSET_DEG, strict=True):
        both = [
            Compared.of(_ours(curves, ANGLE, name), column_of(capture, f"{side}ThoraxAngles", column))
            for side, curves in zip("RL", sides, strict=True)
        ]
        if all(np.isfinite(one.offset) for one in both):
            most = max(abs(one.offset) for one in both)
            title = f"{walk}, {name.replace('_', ' ')}"
            yield Check(f"{title}: mean difference", most, MOST_OFFSET_DEG[plane], "<=", "°")
            yield from _sign(title, both, LEAST_MOVED_DEG)


def followed(walk: Archive, data: Path) -> tuple[Capture, Reconstruction]:
    """A walk, and its motion by the marker filter with inverse dynamics."""
    capture = read_capture(data / walk.folder / walk.trial)
    static = None if walk.static is None else read_capture(data / walk.folder / walk.static)
    subject = scale(static, [capture], mass_kg=walk.mass_kg)
    settings = ReconstructSettings(filter="kinematic", smooth=True)
    return capture, reconstruct(capture, subject, settings=settings)


def column_of(capture: Capture, name: str, column: int) -> Array:
    """(T,) a column of an output, degrees or N mm/kg; NaN where it has no value.

    Args:
        capture: The walk.
        name: The output.
        column: Its column.
    """
    point = next((one for one in capture.derived if one.name == name), None)
    if point is None:
        return np.full(len(capture.markers.positions_m), np.nan)
    return np.where((point.values == 0.0).all(axis=1), np.nan, point.values[:, column])


def _curves(r: Reconstruction, side: int, convention: Convention) -> dict[Key, SideCurve]:
    return {Key(one.quantity, one.name): one for one in side_views(r, side, convention)}


def _ours(curves: dict[Key, SideCurve], quantity: str, name: str) -> Array:
    one = curves.get(Key(quantity, name))
    return np.full(len(next(iter(curves.values())).value), np.nan) if one is None else one.value
