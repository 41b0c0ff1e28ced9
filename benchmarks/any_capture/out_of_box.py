"""Strangers' captures by the command line, as a person would type it: info, scale, reconstruct and report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, number
from benchmarks.commands import typed
from mbkf.io.axes import axes_matrix
from mbkf.io.storage import read_storage
from mbkf.io.subject import read_subject
from mbkf.trial.axes.captures import REPORT_KEY

KNEE_DEG = (-5.0, 75.0)
"""A walker's knee."""


@dataclass(frozen=True)
class Stranger:
    """A capture of another laboratory.

    Attributes:
        name: For the rows.
        folder: Its folder, below the data folder.
        trial: The trial that is reconstructed.
        mass_kg: The person.
        most_mm: Largest marker RMS.
        static: Standing trial; the trial itself is scaled from where there is none.
        forces: Ground reactions beside the trial.
        mirrored: Whether the file is a mirror image, as its walker shows.
        person: Of several persons in the file the one to take, as ``--person`` names it.
    """

    name: str
    folder: str
    trial: str
    mass_kg: float
    most_mm: float
    static: str | None = None
    forces: str | None = None
    mirrored: bool = False
    person: str | None = None


STRANGERS = (
    Stranger("rehazenter", "rehazenter_walk", "2014001_C1_01.c3d", 67.0, 6.0, "2014001_ST_static.c3d"),
    Stranger("bmc run", "bmc_walk_run", "run.trc", 70.0, 8.0, "run_static.trc", "run_grf.mot"),
    Stranger(
        "bmc lower walk",
        "bmc_walk_run",
        "lower_walk1.trc",
        70.0,
        6.0,
        forces="lower_walk1.forces",
        mirrored=True,
    ),
    Stranger("biobuddy", "biobuddy_functional", "functional_right_knee.c3d", 62.0, 6.0, "static.c3d"),
    Stranger("cgm24", "cgm24_lowerlimb_walk", "CGM24_Walking01.c3d", 77.6, 6.0),
    Stranger("stoop lift", "stoop_lift_box", "stoop1_t169_f620f800.c3d", 81.7, 15.0, "neu_t169_f250f350.c3d"),
)


def out_of_box_rows(data: Path, out: Path) -> list[Check]:
    """The rows of all captures: steps that fail, marker RMS, and what is special about one.

    Args:
        data: Folder of the reference captures.
        out: Folder for the results.
    """
    return [row for one in STRANGERS for row in stranger_rows(one, data, out / one.name.replace(" ", "_"))]


def stranger_rows(one: Stranger, data: Path, out: Path) -> list[Check]:
    """The rows of a capture.

    Args:
        one: The capture.
        data: Folder of the reference captures.
        out: Folder for its results.
    """
    out.mkdir(parents=True, exist_ok=True)
    codes = [said(words, out / f"{words[0]}.txt") for words in steps(one, data, out)]
    failed = sum(code != 0 for code in codes)
    name = f"out of the box, {one.name}"
    rows = [Check(f"{name}: steps that fail", failed, 0, "<=")]
    summary = out / "result" / "summary.json"
    rms = json.loads(summary.read_text())["marker_rms_mm"] if summary.is_file() else None
    rows.append(Check(f"{name}: marker RMS", number(rms), one.most_mm, "<=", "mm"))
    if one.mirrored:
        found = not failed and reflected(out / "subject.toml")
        rows.append(Check(f"{name}: reflection found", float(found), 1.0, ">="))
        low, high = knee_range_deg(out / "result") if not failed else (np.nan, np.nan)
        rows += [
            Check(f"{name}: least knee flexion", low, KNEE_DEG[0], ">=", "°"),
            Check(f"{name}: greatest knee flexion", high, KNEE_DEG[1], "<=", "°"),
        ]
    return rows


def steps(one: Stranger, data: Path, out: Path) -> list[list[str]]:
    """What is typed after ``mbkf``, line by line.

    Args:
        one: The capture.
        data: Folder of the reference captures.
        out: Folder for its results.
    """
    folder = data / one.folder
    trial, subject, result = str(folder / one.trial), str(out / "subject.toml"), str(out / "result")
    forces = [] if one.forces is None else ["--forces", str(folder / one.forces)]
    person = [] if one.person is None else ["--person", one.person]
    scaled_from = ["--trial", trial] if one.static is None else [str(folder / one.static)]
    return [
        ["info", trial, *forces, *person],
        ["scale", *scaled_from, *person, "--mass", f"{one.mass_kg:g}", "--out", subject],
        ["reconstruct", trial, "--subject", subject, *forces, *person, "--out", result],
        ["report", result],
    ]


def said(words: Sequence[str], path: Path) -> int:
    """Exit code of a command, with what it printed in a file.

    Args:
        words: What is typed after ``mbkf``.
        path: The file.
    """
    ended = typed(*words)
    path.write_text(f"mbkf {' '.join(words)}\n{ended.text}", encoding="utf-8")
    return ended.code


def reflected(subject: Path) -> bool:
    """Whether a person was scaled from a capture that was found to be a mirror image."""
    told = read_subject(subject).report.get(REPORT_KEY)
    return isinstance(told, list) and any(
        np.linalg.det(axes_matrix(one["read"]) @ axes_matrix(one["used"]).T) < 0.0 for one in told
    )


def knee_range_deg(result: Path) -> tuple[float, float]:
    """Least and greatest flexion of both knees in a folder of results, degrees."""
    table = read_storage(result / "angles.mot")
    knees = np.concatenate([table.column(f"knee_angle_{side}") for side in "rl"])
    return float(np.nanmin(knees)), float(np.nanmax(knees))
