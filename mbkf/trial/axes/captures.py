"""Captures with their axes checked before anything is followed: against a protocol, or against a scaled person."""

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
"""Key of a subject's report under which captures that were put right are told."""


def checked_for_protocol(captures: Sequence[Capture], protocol: Protocol) -> list[Capture]:
    """Captures of a person to be scaled, with their axes checked and put right.

    Args:
        captures: Static and moving trials of one person.
        protocol: The markers they wear.

    Raises:
        InvalidInput: The axes or the unit of a capture cannot be right, and it is not clear what they are.
    """
    places = [
        marker_places(one.markers.names, protocol.match(one.markers.names), protocol.body) for one in captures
    ]
    return right_axes(captures, places, with_plates=False)


def checked_for_subject(capture: Capture, subject: Subject) -> Capture:
    """A trial of a scaled person, with its axes checked and put right.

    A trial that does not tell its axes takes those that the person was scaled with.

    Args:
        capture: The trial.
        subject: The person.

    Raises:
        InvalidInput: The axes or the unit of the trial cannot be right, and it is not clear what they are.
    """
    found = find_axes_for_subject(capture, subject)
    alike = turned_like_subject(capture, subject)
    if alike is not capture and may_follow(found, axes_matrix(alike.axes) @ axes_matrix(capture.axes).T):
        return alike
    return applied(capture, found)


def find_axes_for_subject(capture: Capture, subject: Subject) -> AxesFinding:
    """What a trial of a scaled person tells about its axes."""
    names = capture.markers.names
    places = marker_places(names, match_names(names, subject.markers), reference_body(subject))
    return find_axes(capture, places)


def find_axes_by_names(capture: Capture) -> AxesFinding:
    """What a capture tells about its axes by the markers that any of the shipped protocols knows."""
    return find_axes(capture, marker_places(capture.markers.names, {}, load_body("human18")))


def told_axes(read: Sequence[Capture], checked: Sequence[Capture]) -> list[dict[str, str]]:
    """What was put right of captures, as plain data for the report of the person scaled from them.

    Args:
        read: The captures as they were read.
        checked: The same after the check.
    """
    return [
        {"capture": one.path, "read": one.axes, "used": other.axes, "note": other.notes[-1]}
        for one, other in zip(read, checked, strict=True)
        if other.axes_source is AxesSource.BODY and one.axes_source is not AxesSource.BODY
    ]


def turned_like_subject(capture: Capture, subject: Subject) -> Capture:
    """A capture without evidence of its own in the axes that its person's captures were put right to.

    Args:
        capture: The capture, of unlabelled points perhaps.
        subject: The person.

    Returns:
        The capture itself where the person's captures were right, or read in other axes, or its axes were given.
    """
    if capture.axes_source in (AxesSource.GIVEN, AxesSource.UP_GIVEN, AxesSource.MADE, AxesSource.BODY):
        return capture
    told = subject.report.get(REPORT_KEY)
    for one in told if isinstance(told, list) else []:
        if one["read"] == capture.axes:
            turn = axes_matrix(one["used"]) @ axes_matrix(capture.axes).T
            note = (
                f"axes {one['used']} as in the subject's static trial; --axes={capture.axes} keeps the file's"
            )
            made = put_right(capture, np.asarray(turn))
            return replace(made, notes=(*made.notes, note))
    return capture
