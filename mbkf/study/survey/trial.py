"""Survey of one capture of a session: kind, duration, content and problems."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import MbkfError, UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.session import TrialKind
from mbkf.model.protocol import detect_protocol
from mbkf.study.survey.movement import kind_of_markers
from mbkf.study.survey.problems import Problem
from mbkf.trial.axes.captures import find_axes_by_names
from mbkf.trial.preparation.coverage import use_by_protocol

MISSING_SHARE = 0.2
"""Captures in which a larger share of the samples is missing are reported."""

LEAST_STANDING_KG = 2.0
"""Plates under a standing person read more than this."""

STEADY = 0.03
"""A standing person's weight varies by less than this share of it."""


@dataclass(frozen=True)
class SurveyedTrial:
    """A capture, looked at.

    Attributes:
        path: The capture.
        forces: Ground reactions beside it; None: those of the capture itself.
        kind: Kind of movement.
        seconds, rate_hz: Its length and frame rate; 0 where it cannot be read.
        markers, unnamed: Markers with a name, and trajectories without.
        protocol: The shipped marker protocol that explains them; empty: no protocol does.
        plates, events: How many there are.
        standing_kg: Mass on its plates of a person who stands still; None: unknown.
        stated_kg: Body mass that the file states; None: not stated.
        problems: Its problems.
    """

    path: Path
    forces: Path | None = None
    kind: TrialKind = TrialKind.UNKNOWN
    seconds: float = 0.0
    rate_hz: float = 0.0
    markers: int = 0
    unnamed: int = 0
    protocol: str = ""
    plates: int = 0
    events: int = 0
    standing_kg: float | None = None
    stated_kg: float | None = None
    problems: tuple[Problem, ...] = ()

    @property
    def name(self) -> str:
        """Its name in the session: the file's without the suffix."""
        return self.path.stem

    @property
    def usable(self) -> bool:
        """True without a grave problem."""
        return not any(problem.grave for problem in self.problems)


def survey_trial(path: Path, forces: Path | None = None) -> SurveyedTrial:
    """Looks at a capture; one that cannot be read is reported as a problem.

    Args:
        path: The capture.
        forces: Ground reactions beside it.
    """
    try:
        capture = read_capture(path, forces=forces)
    except (MbkfError, OSError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        unreadable = Problem("unreadable", (why,))
        return SurveyedTrial(path, forces, problems=(unreadable,))
    markers = capture.markers
    unnamed = sum(name.startswith("*") for name in markers.names)
    protocol, doubts = _protocol(capture)
    kind = kind_of_markers(markers)
    return SurveyedTrial(
        path,
        forces,
        kind,
        markers.frames / markers.rate_hz,
        markers.rate_hz,
        len(markers.names) - unnamed,
        unnamed,
        protocol,
        len(capture.plates),
        len(capture.events),
        standing_mass(capture) if kind == TrialKind.STATIC else None,
        capture.subject_mass_kg,
        (*_of_markers(capture, unnamed), *doubts, *_of_plates(capture)),
    )


def standing_mass(capture: Capture) -> float | None:
    """Mass that the plates under a standing person bear, kg; None: no plates, or their load varies."""
    if not capture.plates:
        return None
    shortest = min(len(plate.force_n) for plate in capture.plates)
    load = np.sum([plate.force_n[:shortest, 2] for plate in capture.plates], axis=0)
    load = load[np.isfinite(load)]
    if not len(load):
        return None
    mass_kg = float(np.median(load)) / GRAVITY_M_S2
    steady = float(np.percentile(np.abs(load - np.median(load)), 75)) < STEADY * GRAVITY_M_S2 * mass_kg
    return mass_kg if mass_kg > LEAST_STANDING_KG and steady else None


def _of_markers(capture: Capture, unnamed: int) -> tuple[Problem, ...]:
    present = capture.markers.present
    if not present.any():
        return (Problem("no_marker"),)
    found = []
    if unnamed == len(capture.markers.names):
        found.append(Problem("no_names"))
    missing = 1.0 - float(present.mean())
    if missing > MISSING_SHARE:
        found.append(Problem("gaps", (f"{100 * missing:.0f}",)))
    return tuple(found)


def _protocol(capture: Capture) -> tuple[str, tuple[Problem, ...]]:
    """The shipped protocol that explains a capture's markers, and doubts about set and axes."""
    if not capture.markers.present.any() or all(name.startswith("*") for name in capture.markers.names):
        return "", ()
    try:
        protocol = detect_protocol(capture.markers.names)
        use = use_by_protocol([capture.markers], protocol)
    except UnknownName:
        return "", (Problem("unknown_set"),)
    if not use.accepted:
        return "", (Problem("partly_known_set", (protocol.name, f"{100 * use.share:.0f}")),)
    axes = find_axes_by_names(capture)
    doubts = [Problem("axes", (axes.note,))] if axes.note else []
    return protocol.name, tuple(doubts)


def _of_plates(capture: Capture) -> tuple[Problem, ...]:
    if capture.plates:
        return ()
    return (Problem("no_plate"),)
