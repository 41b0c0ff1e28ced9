"""Two trees on one capture: what differs, and how much of it rounding alone would do."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.equality.captures import Captured, Run
from benchmarks.equality.compare import BOUND, Verdict, difference, numbers_in_folder, verdict
from benchmarks.equality.runs import Outcome, Tree

PREPARED = "prepared"
DIRECTIONS = {"up": np.inf, "down": -np.inf}

_NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")
_NUDGED_LINES = ("mass_kg", "position_m")


@dataclass(frozen=True)
class Beyond:
    """An array beyond the bound: its difference, and the old tree's own from the last digit of its input."""

    name: str
    value: float
    rounding: float


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes:
        capture: The capture.
        run: Filter and mode, or that it is about what was prepared.
        value: The largest difference as a share of its array's largest value.
        worst: Where it was found, or why the captures cannot be compared.
        arrays: How many arrays were compared; 0 where both trees refuse the command.
        passed: Whether the bound is kept.
        beyond: The arrays beyond the bound, the farthest first; rounding is NaN where it is not known.
        times_rounding: The largest difference of them as a multiple of rounding, which counts at least as the
            bound; infinite where it is not known.
    """

    capture: str
    run: str
    value: float
    worst: str
    arrays: int
    passed: bool
    beyond: tuple[Beyond, ...] = ()
    times_rounding: float = np.inf


@dataclass(frozen=True)
class Comparison:
    """Two trees and how their results are compared.

    Attributes:
        old: The tree that is right.
        new: The tree to compare.
        renamed: Names of the old tree's arrays that the new one gives another.
        keep: Whether the new tree's results stay where they are equal.
        nudged: The old tree with a folder for results of nudged subjects; None where rounding is not asked for.
    """

    old: Tree
    new: Tree
    renamed: Mapping[str, str]
    keep: bool
    nudged: Tree | None = None

    def prepared(self, capture: Captured) -> Row:
        """What both trees prepare for a capture: persons, synthetic motions, virtual sensors."""
        return self._row(capture.name, PREPARED, self.old.prepare(capture), self.new.prepare(capture))

    def followed(self, job: tuple[Captured, Run]) -> Row:
        """What both trees find in a capture with the old tree's person."""
        capture, run = job
        made = self.old.prepare(capture).folder
        old, new = (tree.follow(capture, run, made) for tree in (self.old, self.new))
        row = self._row(capture.name, run.name, old, new)
        if row.passed or self.nudged is None or not row.beyond:
            return row
        return with_rounding(row, self._rounding(capture, run, old))

    def _row(self, capture: str, run: str, old: Outcome, new: Outcome) -> Row:
        found = compared_folders(old, new, self.renamed)
        if found.equal and not self.keep and self.new != self.old:
            shutil.rmtree(new.folder, ignore_errors=True)
        farthest = sorted(found.beyond.items(), key=lambda item: -item[1])
        beyond = tuple(Beyond(name, value, np.nan) for name, value in farthest)
        return Row(capture, run, found.value, found.worst, found.arrays, found.equal, beyond)

    def _rounding(self, capture: Captured, run: Run, old: Outcome) -> dict[str, float]:
        """How far the last digit of the subject's numbers moves each array of the old tree."""
        assert self.nudged is not None
        was = numbers_in_folder(old.folder, self.renamed)
        found = dict.fromkeys(was, 0.0)
        for direction, towards in DIRECTIONS.items():
            tree = replace(self.nudged, out=self.nudged.out / direction)
            made = tree.out / capture.name / f"{run.name}-made"
            shutil.copytree(self.old.prepare(capture).folder, made, dirs_exist_ok=True)
            subject = made / "subject.toml"
            subject.write_text(nudged(subject.read_text(encoding="utf-8"), towards), encoding="utf-8")
            outcome = tree.follow(capture, run, made)
            shutil.rmtree(made)
            if outcome.code == 0:
                now = numbers_in_folder(outcome.folder, self.renamed)
                for name in was.keys() & now.keys():
                    found[name] = max(found[name], difference(was[name], now[name])[0])
        return found


def compared_folders(old: Outcome, new: Outcome, renamed: Mapping[str, str] | None = None) -> Verdict:
    """Compares what two commands left; refusing alike is being equal.

    Args:
        old: The old tree's.
        new: The new tree's.
        renamed: Names of the old tree's arrays that the new one gives another.
    """
    if old.code or new.code:
        value = 0.0 if old.code == new.code else np.inf
        message = "both refuse" if old.code == new.code else f"exit code {old.code} became {new.code}"
        return Verdict(value, f"{message}: {new.message or old.message}", 0)
    return verdict(numbers_in_folder(old.folder, renamed), numbers_in_folder(new.folder))


def nudged(subject: str, towards: float) -> str:
    """A subject file's text with mass and marker positions moved by their last binary digit."""

    def next_one(match: re.Match[str]) -> str:
        return repr(float(np.nextafter(float(match[0]), towards)))

    lines = subject.splitlines(keepends=True)
    return "".join(_NUMBER.sub(next_one, s) if s.lstrip().startswith(_NUDGED_LINES) else s for s in lines)


def with_rounding(row: Row, rounding: Mapping[str, float]) -> Row:
    """The row with what rounding does to each of its arrays beyond the bound."""
    beyond = tuple(replace(found, rounding=rounding.get(found.name, 0.0)) for found in row.beyond)
    ratios = [found.value / max(found.rounding, BOUND) for found in beyond if found.rounding < np.inf]
    return replace(row, beyond=beyond, times_rounding=max(ratios, default=np.inf))
