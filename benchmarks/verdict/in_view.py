"""A second person in view: pairs of public captures side by side, under names of their own and without names.

The bounds (:mod:`mbkf.trial.preparation.in_view`) were set before these pairs were made; all captures of one person and
the files with two persons were looked at after.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check
from benchmarks.verdict.persons import MORE, PUBLIC, capture_of, subject_of
from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories
from mbkf.trial.checks.in_view import in_view_finding
from mbkf.trial.preparation.coverage import use_by_subject

BESIDE_M, FRAMES = 1.2, 150
"""Distance of the second person to the left of the first, and frames of a pair."""

TWO_PERSONS = {
    "two_persons_art/ART-Human_2persons_integer.c3d": "Human1:",
    "strangers3/two_persons_pig.trc": "A:",
}
"""Files with two persons, and the prefix of the first one's markers."""


def second_person_rows(data: Path, quick: bool = False) -> Iterator[Check]:
    """Rows of two persons that are reported, and of single ones that are taken for two.

    Args:
        data: Folder of the reference captures.
        quick: Three pairs.
    """
    names = [name for name in sorted(PUBLIC) if name in MORE]
    names = names[:3] if quick else names
    captures = {name: _middle(capture_of(name, data).markers) for name in names}
    own = {
        name: use_by_subject(one, subject_of(name, data)).used
        for name, one in captures.items()
        if name in MORE
    }
    single = [in_view_finding(captures[name], used).verdict for name, used in own.items()]
    pairs = []
    for first, second in zip(own, [*list(own)[1:], next(iter(own))], strict=True):
        for write in ("B:{}", "*{}"):
            both = _beside(captures[first], captures[second], write)
            pairs.append(in_view_finding(both, own[first]).verdict)
    for file, prefix in TWO_PERSONS.items():
        markers = read_capture(data / file).markers
        mine = [name for name in markers.names if name.startswith(prefix)]
        pairs.append(in_view_finding(markers, mine).verdict)
    missed, wrong = sum(one == "inside" for one in pairs), sum(one == "outside" for one in single)
    yield Check(f"two persons in view that are not reported ({len(pairs)} captures)", missed, 0, "<=", "")
    yield Check(f"one person taken for two ({len(single)} captures)", wrong, 0, "<=", "")


def _middle(markers: MarkerTrajectories) -> MarkerTrajectories:
    first = max(0, (markers.frames - FRAMES) // 2)
    return MarkerTrajectories(markers.names, markers.positions_m[first : first + FRAMES], markers.rate_hz)


def _beside(one: MarkerTrajectories, other: MarkerTrajectories, write: str) -> MarkerTrajectories:
    """The first with the second beside it, whose names are written otherwise; frames repeat where there are fewer."""
    theirs = other.positions_m[np.arange(one.frames) % other.frames]
    middles = [np.nanmean(each, axis=(0, 1)) for each in (one.positions_m, theirs)]
    moved = theirs - middles[1] + middles[0] + [0.0, BESIDE_M, 0.0]
    names = (*one.names, *(write.format(name) for name in other.names))
    return MarkerTrajectories(names, np.concatenate([one.positions_m, moved], axis=1), one.rate_hz)
