"""One person in view: markers of somebody else beside the subject's (:mod:`mbkf.trial.preparation.in_view`)."""

from __future__ import annotations

from collections.abc import Collection

from mbkf.io.findings import INSIDE_SD, Finding, judged, not_judged
from mbkf.io.records import MarkerTrajectories
from mbkf.trial.preparation.in_view import LEAST_MARKERS, others_in_view

NAME = "one person in view"

BOUND = LEAST_MARKERS - 1
"""Markers of somebody else that are objects beside the subject."""

REMEDY = "; make sure that this person is followed, or record one person alone"


def unseen_finding() -> Finding:
    """The check of a live run, whose log holds the subject's markers alone."""
    return not_judged(NAME, "markers", BOUND, "a live run knows others by their names only, and reports them")


def in_view_finding(markers: MarkerTrajectories, own: Collection[str]) -> Finding:
    """The number of markers that are somebody else's.

    Args:
        markers: All markers of the capture.
        own: Names of those that are the subject's.
    """
    others = others_in_view(markers, own)
    hint = others.sentence if others.names else "all markers are the subject's, or near it"
    return judged(NAME, float(len(others.names)), BOUND / INSIDE_SD, "markers", BOUND, hint, REMEDY)
