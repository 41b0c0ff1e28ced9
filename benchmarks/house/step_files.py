"""Files of one dynamic step: those that the page "one step, file by file" lists, their lines, and what a step executes.

The page holds two lists as fenced blocks, :data:`READ` in reading order and :data:`LEFT_OUT` with a reason for each.
Lines are counted in the tree when they are asked for, so that no number in the page can grow old.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import mbkf
from benchmarks.kernel import using
from mbkf.errors import InvalidInput
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.kernel.loading import REFERENCE
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.contact.records import Contact
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "one_step.md"
PACKAGE = Path(mbkf.__file__).resolve().parent

READ, LEFT_OUT = "step-files", "step-files-left-out"
"""Names of the page's two lists."""

ROOMS = ("filters", "sensors", "numerics")
"""Rooms in which every executed file has to be in one of the lists; the body model (mbkf/model) is another matter."""

SECONDS, FRAME = 1.5, 100
"""A synthetic squat, and the frame whose step is looked at."""

_ENTRY = re.compile(r"([\w/]+\.py): (.*)")


class StepFile(NamedTuple):
    """A file of a step: path within the package, what it does there in a sentence, number of its lines."""

    path: str
    sentence: str
    lines: int


def parsed(text: Iterable[str], package: Path = PACKAGE) -> list[StepFile]:
    """Entries ``path: sentence``, of which a sentence may go on in the lines below.

    Raises:
        InvalidInput: A line belongs to no entry, or a file does not exist.
    """
    found: list[tuple[str, str]] = []
    for line in text:
        entry = _ENTRY.fullmatch(line.strip())
        if entry:
            found.append((entry[1], entry[2]))
        elif found and line.strip():
            found[-1] = found[-1][0], f"{found[-1][1]} {line.strip()}"
        elif line.strip():
            raise InvalidInput(f"'{line.strip()}' belongs to no file; write 'folder/file.py: sentence'")
    for path, _ in found:
        if not (package / path).is_file():
            raise InvalidInput(f"{path}: no such file in {package}; bring the page on one step up to date")
    return [StepFile(path, said, lines_of(package / path)) for path, said in found]


def listed(kind: str, page: Path = PAGE) -> list[StepFile]:
    """One of the page's lists.

    Raises:
        InvalidInput: The page has no such list, or it names a file that does not exist.
    """
    text = page.read_text(encoding="utf-8")
    found = re.search(rf"^```\{{{kind}\}}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    if found is None:
        raise InvalidInput(f"{page}: no list ```{{{kind}}}")
    return parsed(found[1].splitlines())


def lines_of(path: Path) -> int:
    """Lines of a file, blank ones and documentation included."""
    return len(path.read_text(encoding="utf-8").splitlines())


def undeclared(executed: Iterable[str], page: Path = PAGE) -> list[str]:
    """Executed files of the rooms that the page neither lists nor leaves out with a reason."""
    known = {one.path for kind in (READ, LEFT_OUT) for one in listed(kind, page)}
    return sorted(path for path in executed if path.split("/")[0] in ROOMS and path not in known)


def executed_in_a_step() -> set[str]:
    """Files of the package that one dynamic step executes, all markers seen and both feet on plates.

    The step is the reference's: the compiled kernel does the same by other files (``mbkf/kernel``).

    Raises:
        InvalidInput: The frame that was chosen is not like that.
    """
    with using(REFERENCE), single_threaded():
        kalman, recording = _squat()
        before = kalman.start(recording, 0, None)
        if before is None:
            raise InvalidInput("the synthetic squat does not start")
        for t in range(1, FRAME):
            before = kalman.step(before, recording, t)
        with _watched() as files:
            # The step after it asks for what this one keeps in mind.
            after = kalman.step(before, recording, FRAME)
            kalman.step(after, recording, FRAME + 1)
    assert after.record.step is not None
    notes = after.record.step.decisions.notes
    on_plates = notes.contact is not None and set(notes.contact.contacts) == {Contact.MEASURED}
    if not (notes.seen.all() and notes.trusted.all() and on_plates):
        raise InvalidInput(f"frame {FRAME}: not every marker is seen, or a foot is off its plate")
    return files


def _squat() -> tuple[TrackingFilter, Recording]:
    person, recorded = mbkf.synthesise("squat", seconds=SECONDS, seed=1)
    shown = subject_markers(recorded.trial.markers, person)
    inputs, recording = trial_inputs(shown, recorded.trial.plates, person, ReconstructSettings())
    return tracking_filter("dynamic", inputs), recording


@contextmanager
def _watched() -> Iterator[set[str]]:
    """Collects the package's files whose functions are called."""
    files: set[str] = set()

    def note(frame: FrameType, event: str, argument: Any) -> None:
        del argument
        if event == "call":
            path = Path(frame.f_code.co_filename)
            if PACKAGE in path.parents:
                files.add(path.relative_to(PACKAGE).as_posix())

    sys.setprofile(note)
    try:
        yield files
    finally:
        sys.setprofile(None)
