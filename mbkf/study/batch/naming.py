"""Captures whose points have no names: the person found from them, and names before they are reconstructed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.printed import percent
from mbkf.trial.axes.captures import turned_like_subject

if TYPE_CHECKING:
    from mbkf.trial.labelling.result import LabelSummary

NAMED_SHARE = 0.5
"""A capture that names a smaller share of the person's markers, and has points without names, is labelled."""


@dataclass(frozen=True)
class Named:
    """A capture with names.

    Attributes:
        capture: The capture to reconstruct.
        summary: The labeller's summary; None where the capture's own names were enough.
        warnings: Names that may be wrong.
    """

    capture: Capture
    summary: LabelSummary | None = None
    warnings: tuple[str, ...] = ()


def is_nameless(capture: Capture) -> bool:
    """True where every point of a capture lacks a name."""
    return all(name.startswith("*") for name in capture.markers.names)


def body_of_points(capture: Capture, mass_kg: float, height_m: float | None, protocol: str | None) -> Subject:
    """The person that the points of a capture without names show.

    Args:
        capture: The capture.
        mass_kg: Body mass, kg.
        height_m: Body height, m, if known.
        protocol: The markers that were worn; None: a set inferred from the points.

    Raises:
        NotObservable: Too few points, or the body fits none of them.
        NotConverged: The points do not fit a person.
    """
    from mbkf.trial.label_nameless import label_nameless  # labelling loads slowly
    from mbkf.trial.label_unscaled import label_unscaled

    if protocol is None:
        return label_nameless(capture, mass_kg=mass_kg, height_m=height_m)[1]
    return label_unscaled(capture, protocol, mass_kg=mass_kg, height_m=height_m)[1]


def needs_names(capture: Capture, subject: Subject) -> bool:
    """True where most of a person's markers are points without names in a capture.

    Args:
        capture: The capture.
        subject: The scaled person.
    """
    names = set(capture.markers.names)
    own = [marker.name for marker in subject.markers]
    known = sum(name in names for name in own)
    unnamed = sum(name.startswith("*") for name in names)
    return unnamed > 0 and known < NAMED_SHARE * len(own)


def named(capture: Capture, subject: Subject) -> Named:
    """The capture, labelled where its points have no names.

    Args:
        capture: The capture.
        subject: The scaled person.

    Raises:
        NotObservable: Too few points are seen to name them.
    """
    if not needs_names(capture, subject):
        return Named(capture)
    from mbkf.trial.label import label  # loads slowly
    from mbkf.trial.labelling.result import label_summary, labelled_capture

    turned = turned_like_subject(capture, subject)
    found = label(turned, subject)
    doubts = () if found.doubts is None else tuple(found.doubts.warnings())
    share = f"{percent(found.assigned_fraction, 1)} of the marker samples have a point"
    note = f"the points had no names and were labelled: {share}"
    return Named(labelled_capture(turned, found), label_summary(found), (note, *doubts))
