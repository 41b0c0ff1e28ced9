"""Labels against the truth: samples with the right name, with a wrong one, and without."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, match_names

SAME_POINT_M = 0.0005
"""Samples nearer than this are the same point (C3D keeps 32-bit floats)."""


@dataclass(frozen=True)
class LabelScore:
    """Counts over all frames.

    Attributes:
        names: The M markers that the subject and the truth share.
        right: (T, M) the marker is where the truth has it.
        wrong: (T, M) the label is on another marker's point, or on a ghost.
        missed: (T, M) the truth has the marker, the labels do not.
        present: Marker-samples in the truth.
    """

    names: tuple[str, ...]
    right: BoolArray
    wrong: BoolArray
    missed: BoolArray
    present: int

    @property
    def correct_fraction(self) -> float:
        """Right samples over those in the truth."""
        return float(self.right.sum()) / self.present

    @property
    def wrong_fraction(self) -> float:
        """Wrong samples over those in the truth."""
        return float(self.wrong.sum()) / self.present

    @property
    def missed_fraction(self) -> float:
        """Missed samples over those in the truth."""
        return float(self.missed.sum()) / self.present


def score(found: MarkerTrajectories, truth: MarkerTrajectories, subject: Subject) -> LabelScore:
    """Compares labelled trajectories with the truth over the same frames.

    A subject's marker that the truth does not have at all counts as wrong wherever it was labelled.

    Args:
        found: Labelled, under the subject's names.
        truth: Under the names of the laboratory.
        subject: Its markers' names and aliases.

    Raises:
        InvalidInput: The two have different numbers of frames, or no marker in common.
    """
    if found.frames != truth.frames:
        raise InvalidInput(
            f"the truth has {truth.frames} frames, the labelled capture {found.frames}; "
            "give the labelled file of the same trial to --truth"
        )
    matched = {marker.name: name for name, marker in match_names(truth.names, subject.markers).items()}
    names = tuple(dict.fromkeys((*matched, *found.names)))
    ours, theirs = _columns(found, names, {n: n for n in found.names}), _columns(truth, names, matched)
    has = np.asarray(~np.isnan(ours).any(axis=2))
    should = np.asarray(~np.isnan(theirs).any(axis=2))
    if not should.any():
        raise InvalidInput(
            "the truth has no marker of the subject; give the labelled file of the same trial to --truth"
        )
    same = np.linalg.norm(ours - theirs, axis=2) <= SAME_POINT_M
    return LabelScore(names, same, has & ~same, should & ~has, int(should.sum()))


def _columns(markers: MarkerTrajectories, names: tuple[str, ...], own: dict[str, str]) -> Array:
    """(T, M, 3) in the order of ``names``; NaN for those that have no trajectory."""
    columns = np.full((markers.frames, len(names), 3), np.nan)
    place = {name: k for k, name in enumerate(markers.names)}
    for k, name in enumerate(names):
        if name in own:
            columns[:, k] = markers.positions_m[:, place[own[name]]]
    return columns
