"""The clinic: conventions, electromyograms, scores and norms against scipy, truth and independent implementations.

``python -m benchmarks clinic --only PART`` runs one part; ``--only`` may be repeated.
"""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.checks import Check, Context
from benchmarks.clinic.convention import convention_rows
from benchmarks.clinic.emg import emg_rows
from benchmarks.clinic.norms import norms_rows
from benchmarks.clinic.page import page_rows
from benchmarks.clinic.scores import score_rows
from benchmarks.clinic.screenshots import screenshot_rows
from benchmarks.clinic.sessions import sessions_rows
from benchmarks.clinic.sheet import sheet_rows
from benchmarks.clinic.straight import straight_rows
from benchmarks.clinic.video import video_rows
from benchmarks.clinic.words import words_rows
from benchmarks.parts import Part, part_rows

PARTS: Mapping[str, Part] = {
    "convention": lambda context: convention_rows(context.require_data()),
    "emg": lambda context: emg_rows(context.require_data(), context.quick, context.out),
    "norms": lambda context: norms_rows(context.out),
    "page": lambda context: page_rows(context.out, context.seed),
    "scores": lambda _: score_rows(),
    "screenshots": lambda context: screenshot_rows(context.require_data(), context.out),
    "sessions": lambda context: sessions_rows(context.require_data(), context.out),
    "sheet": lambda context: sheet_rows(context.require_data(), context.out),
    "straight": lambda context: straight_rows(context.require_data()),
    "video": lambda context: video_rows(context.out, context.seed),
    "words": lambda context: words_rows(context.require_data(), context.out),
}
"""Rows by the part's name."""


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    return part_rows(context, PARTS)
