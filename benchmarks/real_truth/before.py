"""Values of the tree before skin and joint centres were in the model, and markers of all real captures against them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, number
from benchmarks.commands import mbkf
from benchmarks.dynamic.methods import Mapper
from benchmarks.equality.captures import CAPTURES, Captured
from mbkf.errors import MbkfError
from mbkf.io.results_folder import read_summary

BEFORE = Path(__file__).with_name("before.toml")

MOST_RATIO = 1.15


@dataclass(frozen=True)
class Task:
    """A capture and the folders of data and results."""

    capture: Captured
    data: Path
    out: Path


def stated(table: str) -> dict[str, float]:
    """A table of the values before.

    Args:
        table: "marker_rms_mm" by capture or "varying_deg" by coordinate.
    """
    found: dict[str, float] = tomllib.loads(BEFORE.read_text(encoding="utf-8"))[table]
    return found


def before_rows(data: Path, out: Path, mapper: Mapper) -> list[Check]:
    """Ratio of marker RMS to that of the tree before, one row a capture.

    Args:
        data: Folder of the reference captures.
        out: Folder for results.
        mapper: Runs captures side by side.
    """
    before = stated("marker_rms_mm")
    held = [one for one in CAPTURES if one.name in before]
    found = mapper(marker_rms_mm, [Task(one, data, out / "captures" / one.name) for one in held])
    return [
        Check(f"{one.name}: marker RMS over that before", rms / before[one.name], MOST_RATIO, "<=")
        for one, rms in zip(held, found, strict=True)
    ]


def marker_rms_mm(task: Task) -> float:
    """Marker RMS by the default filter of a person scaled from standing; NaN where a command fails.

    Args:
        task: The capture.
    """
    folders = {"data": str(task.data), "made": str(task.out)}
    task.out.mkdir(parents=True, exist_ok=True)

    def filled(words: tuple[str, ...]) -> list[str]:
        return [word.format(**folders) for word in words]

    one, result = task.capture, task.out / "result"
    try:
        for words in one.prepare:
            mbkf(*filled(words))
        subject = ("--subject", "{made}/subject.toml")
        mbkf("reconstruct", *filled((one.trial, *subject, *one.options)), "--out", result)
    except MbkfError:
        return float("nan")
    return number(read_summary(result)["marker_rms_mm"])
