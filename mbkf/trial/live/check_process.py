"""The process that checks a live run while it goes on, so that the filter's frames do not wait for it.

It reads the run's log as far as it has been written and repeats the checks of ``reconstruct`` on it
(:func:`mbkf.trial.live.results.checks_of`): a line on its standard input asks for that, a line of JSON on its standard
output answers. The process ends when its input closes, also where its parent was killed.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from mbkf.errors import MbkfError
from mbkf.io.findings import Finding
from mbkf.io.subject import read_subject
from mbkf.numerics.threads import single_threaded
from mbkf.trial.checks.persons import finding_of_markers
from mbkf.trial.live.log import SUBJECT_FILE, read_live_log
from mbkf.trial.live.results import CHECKED_S, checks_of, measured_of
from mbkf.trial.preparation.exchanged import names_put_right
from mbkf.trial.preparation.settings import ReconstructSettings

NICENESS = 10
"""Added to the process's own, so that the filter goes first where there is one core."""


class Answer(NamedTuple):
    """Checks of a run so far.

    Attributes:
        findings: The findings.
        exchanged: Pairs of markers that have each other's names, and the share of the frames in which they do.
    """

    findings: tuple[Finding, ...] = ()
    exchanged: tuple[tuple[str, str, float], ...] = ()


def answers(folder: Path, asked: Iterable[str]) -> Iterator[str]:
    """A line of JSON for each line that asks: "check", or "person" and the frame from which the person is judged.

    Args:
        folder: The run's log.
        asked: Lines that ask.
    """
    for line in asked:
        kind, *since = line.split()
        found = person_since(folder, int(since[0])) if kind == "person" else checks_so_far(folder)
        plain = {"findings": [one.as_table() for one in found.findings], "exchanged": found.exchanged}
        yield json.dumps(plain)


def answer_of(line: str) -> Answer:
    """The checks of an answer.

    Args:
        line: Line of JSON.
    """
    plain = json.loads(line)
    findings = tuple(Finding(**one) for one in plain["findings"])
    return Answer(findings, tuple((a, b, share) for a, b, share in plain["exchanged"]))


def checks_so_far(folder: Path) -> Answer:
    """Checks of a run as far as its log has been written; none where nothing can be checked yet.

    Args:
        folder: The run's log.
    """
    try:
        logged = read_live_log(folder)
        settings = ReconstructSettings(
            filter=str(logged.settings["filter"]), smooth=False, correct_markers=False
        )
        subject = read_subject(folder / SUBJECT_FILE)
        with single_threaded():
            found = checks_of(logged, subject, settings)
            measured = measured_of(logged, CHECKED_S)
            _, exchanged = names_put_right(measured, subject)
    except MbkfError:  # the log is empty so far, or was removed at the end of the run
        return Answer()
    return Answer(found, tuple((a, b, frames / measured.frames) for a, b, frames in exchanged))


def person_since(folder: Path, frame: int) -> Answer:
    """Segment lengths that the markers show from a frame on, against those of the subject.

    Args:
        folder: The run's log.
        frame: The frame, counted from the first one.
    """
    try:
        logged = read_live_log(folder)
        subject = read_subject(folder / SUBJECT_FILE)
        since = replace(logged, rows=logged.rows[frame:])
        with single_threaded():
            return Answer((finding_of_markers(subject, measured_of(since, CHECKED_S)),))
    except MbkfError:
        return Answer()


def main() -> None:
    """Answers its parent until the input closes."""
    with contextlib.suppress(OSError, AttributeError):  # Windows has no niceness
        os.nice(NICENESS)
    for line in answers(Path(sys.argv[1]), sys.stdin):
        print(line, flush=True)  # noqa: T201
