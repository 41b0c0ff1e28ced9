"""Problems of a session or a capture, and their remedies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

TEXTS: Mapping[str, tuple[str, str]] = {
    "unreadable": ("cannot be read: {0}", "export it again, or leave it out"),
    "no_marker": ("no markers are visible", "leave it out, or export its markers"),
    "no_names": ("its points have no names", "the run names them by the scaled body"),
    "gaps": ("{0} % of the marker samples are missing", "intervals are wider there"),
    "unknown_set": ("its marker set is not known", "it is inferred; check it in the marker editor"),
    "partly_known_set": (
        "marker set {0} knows only {1} % of its markers",
        "the set is inferred; check it in the marker editor",
    ),
    "axes": ("{0}", "check the trial in 3-D"),
    "no_plate": ("no force plate", "torques are estimated, with wide intervals"),
    "mass": (
        "the stated mass is {0} kg, by the plates it is {1} kg",
        "use the mass by the plates, or check the plates",
    ),
    "no_trial": ("no usable trial", "add captures with markers"),
    "no_static": ("no standing trial", "the body is scaled from moving trials, with more uncertainty"),
    "session_file": (
        "{0}",
        "correct that line of the file in a text editor, or rename the file and enter person and trials here again",
    ),
    "strange_trial": ("{0}", "add the capture again; without it this entry has no effect"),
    "frames_lost": ("{0} of {1} frames were lost", "their times are kept with the recording"),
}
"""Problem and remedy by key; {0} and {1} stand for values."""

GRAVE = frozenset({"unreadable", "no_marker", "no_trial", "session_file"})
"""With these a capture, or the session, cannot be used as it is."""

OF_MARKER_SET = frozenset({"unknown_set", "partly_known_set"})
"""These the marker editor puts right."""


@dataclass(frozen=True)
class Problem:
    """Something about a capture or a session that a person should know.

    Attributes:
        key: One of :data:`TEXTS`; pages say it in their language.
        values: Values filled into the text.
    """

    key: str
    values: tuple[str, ...] = ()

    @property
    def what(self) -> str:
        """The problem, in English."""
        text = TEXTS[self.key][0]
        for k, value in enumerate(self.values):
            text = text.replace(f"{{{k}}}", value)
        return text

    @property
    def todo(self) -> str:
        """The remedy, in English."""
        return TEXTS[self.key][1]

    @property
    def grave(self) -> bool:
        """True where the capture or session cannot be used as it is."""
        return self.key in GRAVE

    @property
    def marker_set(self) -> bool:
        """True for problems of the marker set, which the marker editor puts right."""
        return self.key in OF_MARKER_SET


def plain_problem(problem: Problem) -> dict[str, object]:
    """Problem and remedy as plain data."""
    return {
        "key": problem.key,
        "values": list(problem.values),
        "what": problem.what,
        "todo": problem.todo,
        "grave": problem.grave,
        "marker_set": problem.marker_set,
    }
