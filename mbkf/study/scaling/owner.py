"""The reference capture whose person and markers a trial shows: a standing trial, or a moving one without any.

Two questions are asked of a trial and a reference. Are the markers where they were: by distances between markers of one
segment (:mod:`mbkf.study.scaling.likeness`)? Are the bones those of the reference's body: by segment lengths with all
markers put on anew (:mod:`mbkf.scaling.trial_lengths`)? Markers where they were show person and session at once.
Markers elsewhere on bones of these lengths were put on anew. Other bones are another person's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.numerics.runs import spread_indices
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.correction import trial_lengths
from mbkf.scaling.trial_lengths import LengthEvidence
from mbkf.study.scaling.likeness import Places, StandingMarkers
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.checks.persons import LOOK, changes_in_words
from mbkf.trial.preparation.static_names import markers_as_scaled

OWN_BONES = -2.2
"""Powers of ten for another person below which bones agree. With markers put on anew, five made persons have −2.5 to
−3.7 against their own bodies; persons of nearly one size, made and public, −2.0 and more against each other's."""

MOST_FRAMES = 60
"""Evenly spread frames of a capture that are looked at."""


@dataclass(frozen=True)
class Owner:
    """The reference that a trial belongs to.

    Attributes:
        number: Its number; None where the trial belongs to no reference.
        found: Numbers of the comparison, a clause; empty where the markers are where they were.
    """

    number: int | None
    found: str = ""


class Reference:
    """A capture that stands for a person with markers where they were put on.

    Args:
        name: Its name, for messages.
        subject: The person scaled from it.
        capture: The capture.

    Raises:
        MbkfError: Its axes contradict the body, or it shows too few markers.
    """

    def __init__(self, name: str, subject: Subject, capture: Capture) -> None:
        self.name, self._subject = name, subject
        self._standing = StandingMarkers(subject, checked_for_subject(capture, subject).markers)
        keypoints = sum(marker.correlated_m > 0.0 for marker in subject.markers)
        self.by_bones = 2 * keypoints > len(subject.markers)
        """Key points that a network finds in videos are nowhere put on: bones alone separate persons."""

    def places(self, capture: Capture) -> Places | None:
        """Changes of the markers' places in a trial; None where they cannot be compared, as key points cannot.

        Args:
            capture: The trial.
        """
        markers = None if self.by_bones else self._own(capture)
        return None if markers is None else self._standing.places(markers)

    def lengths(self, capture: Capture) -> LengthEvidence | None:
        """Segment lengths of a trial against those of the body; None where its markers do not fit a body.

        Args:
            capture: The trial.
        """
        markers = self._own(capture)
        try:
            return None if markers is None else trial_lengths(self._subject, markers)
        except MbkfError:
            return None

    def _own(self, capture: Capture) -> MarkerTrajectories | None:
        """The trial's markers under the names of the body; None where it shows too few of them."""
        try:
            with single_threaded():
                return markers_as_scaled(checked_for_subject(capture, self._subject).markers, self._subject)
        except MbkfError:
            return None


def few_frames(capture: Capture) -> Capture:
    """A capture of at most :data:`MOST_FRAMES` frames, evenly spread, without plates."""
    markers = capture.markers
    frames = spread_indices(markers.frames, min(markers.frames, MOST_FRAMES))
    rate_hz = markers.rate_hz * len(frames) / markers.frames
    few = replace(markers, positions_m=markers.positions_m[frames], rate_hz=rate_hz)
    return replace(capture, markers=few, plates=())


def owner_of(
    capture: Capture, references: Sequence[Reference], *, places_alone: bool = False
) -> Owner | None:
    """The reference that a trial belongs to: by its markers' places, else by its bones; None without comparison.

    Args:
        capture: The trial.
        references: Captures of other persons, or with markers elsewhere, each.
        places_alone: True where bones do not count, but of key points, which have no places.
    """
    found = {n: places for n, one in enumerate(references) if (places := one.places(capture)) is not None}
    if not found:
        return _owner_of_keypoints(capture, references)
    nearest = min(found, key=lambda n: found[n].elsewhere)
    if found[nearest].elsewhere < 0.0:
        return Owner(nearest)
    asked = () if places_alone else found
    lengths = {n: known for n in asked if (known := references[n].lengths(capture)) is not None}
    likest = min(lengths, key=lambda n: lengths[n].powers, default=nearest)
    words = (
        f"distances between markers of a segment differ by {found[likest].changed_mm:.0f} mm from those in "
        f"{references[likest].name}"
    )
    if likest not in lengths:
        return Owner(None, words)
    if lengths[likest].powers < OWN_BONES:
        return Owner(likest, f"{words}; lengths of bones agree")
    return Owner(
        None, f"{words} ({changes_in_words(lengths[likest])}): another person, or markers put on anew"
    )


def _owner_of_keypoints(capture: Capture, references: Sequence[Reference]) -> Owner | None:
    """The reference of key points with the likeliest bones, unless these are another person's; None without any."""
    powers = {
        n: lengths for n, one in enumerate(references) if one.by_bones and (lengths := one.lengths(capture))
    }
    if not powers:
        return None
    likest = min(powers, key=lambda n: powers[n].powers)
    if powers[likest].powers < LOOK:
        return Owner(likest)
    return Owner(
        None, f"{changes_in_words(powers[likest])} than in {references[likest].name}: another person"
    )


class Bones(StrEnum):
    """Lengths of bones in two captures, wherever the markers are."""

    AGREE = "agree"
    DIFFER = "differ"
    OPEN = "open"


def bones(capture: Capture, reference: Reference) -> Bones:
    """Compares lengths of bones; open where they suit one person and two, or cannot be compared.

    Args:
        capture: A capture.
        reference: Another one.
    """
    lengths = reference.lengths(capture)
    if lengths is None or OWN_BONES <= lengths.powers < LOOK:
        return Bones.OPEN
    return Bones.AGREE if lengths.powers < OWN_BONES else Bones.DIFFER
