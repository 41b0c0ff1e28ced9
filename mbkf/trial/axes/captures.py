"""Captures with their axes checked before tracking: against a protocol, or against a scaled person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.io.axes import axes_matrix
from mbkf.io.records import AxesSource, Capture
from mbkf.io.subject import Subject, match_names
from mbkf.model.body_file import load_body
from mbkf.model.human import reference_body
from mbkf.model.protocol import Protocol
from mbkf.trial.axes.decision import AxesFinding, applied, find_axes, may_follow, put_right, right_axes
from mbkf.trial.axes.evidence import marker_places

REPORT_KEY = "axes"
"""Key of a subject's report that lists its captures with corrected axes."""


def checked_for_protocol(
    captures: Sequence[Capture], protocol: Protocol, *, standing: int = 0
) -> list[Capture]:
    """Captures of a person to be scaled, with their axes checked and corrected.

    Args:
        captures: Static and moving trials of one person.
        protocol: The markers they wear.
        standing: Number of captures, from the first on, in which the person is known to stand.

    Raises:
        InvalidInput: The axes or the unit of a capture are wrong, and the right ones are not clear.
    """
    places = [
        marker_places(one.markers.names, protocol.match(one.markers.names), protocol.body) for one in captures
    ]
    return right_axes(captures, places, with_plates=False, standing=standing)


def checked_for_subject(capture: Capture, subject: Subject, withheld: Sequence[str] = ()) -> Capture:
    """A trial of a scaled person, with its axes checked and corrected.

    A trial without evidence on its axes takes those that the person was scaled with.

    Args:
        capture: The trial.
        subject: The person.
        withheld: Names of plates that are no evidence.

    Raises:
        InvalidInput: The axes or the unit of the trial are wrong, and the right ones are not clear.
    """
    shown = tuple(plate for plate in capture.plates if plate.name not in withheld)
    found = find_axes_for_subject(replace(capture, plates=shown), subject)
    alike = turned_like_subject(capture, subject)
    if alike is not capture and may_follow(found, axes_matrix(alike.axes) @ axes_matrix(capture.axes).T):
        return alike
    return applied(capture, found)


def find_axes_for_subject(capture: Capture, subject: Subject) -> AxesFinding:
    """Evidence on the axes of a scaled person's trial."""
    names = capture.markers.names
    places = marker_places(names, match_names(names, subject.markers), reference_body(subject))
    return find_axes(capture, places)


def find_axes_by_names(capture: Capture) -> AxesFinding:
    """Evidence on a capture's axes from the markers of any shipped protocol."""
    return find_axes(capture, marker_places(capture.markers.names, {}, load_body("human18")))


def corrected_axes(read: Sequence[Capture], checked: Sequence[Capture]) -> list[dict[str, str]]:
    """Corrections of captures before (``read``) and after the check, as plain data for the subject's report."""
    return [
        {"capture": one.path, "read": one.axes, "used": other.axes, "note": other.notes[-1]}
        for one, other in zip(read, checked, strict=True)
        if other.axes_source is AxesSource.BODY and one.axes_source is not AxesSource.BODY
    ]


def turned_like_subject(capture: Capture, subject: Subject) -> Capture:
    """A capture without evidence on its axes, of unlabelled points perhaps, corrected like those of its subject.

    It is returned as it is if those were right, or read in other axes, or if its axes were given.
    """
    if capture.axes_source in (AxesSource.GIVEN, AxesSource.UP_GIVEN, AxesSource.MADE, AxesSource.BODY):
        return capture
    corrected = subject.report.get(REPORT_KEY)
    for one in corrected if isinstance(corrected, list) else []:
        if one["read"] == capture.axes:
            turn = axes_matrix(one["used"]) @ axes_matrix(capture.axes).T
            note = (
                f"axes {one['used']} as in the subject's static trial; --axes={capture.axes} keeps the file's"
            )
            found = put_right(capture, np.asarray(turn))
            return replace(found, notes=(*found.notes, note))
    return capture
