"""Norms from the sessions of eight persons of which four do not belong, built by the command.

Made walks of four persons belong, without plates. The patient in view, a person who turns, one reconstructed with
another person's size, and one whose age is not stated do not.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import mbkf
from benchmarks.checks import Check
from mbkf.cli.main import main
from mbkf.conventions import Array
from mbkf.io.norms import Norms, read_norms
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import SESSION_FILE, SessionNotes, write_session
from mbkf.trial.results.summary import summarise

BELONG = ("P1", "P2", "P3", "P4")
REASONS = {
    "patient": "person in view",
    "turner": "no walk (turn)",
    "stranger": "do not use",
    "ageless": "age not stated",
}
"""A part of the reason by person."""

SECONDS = 3.5

STATED = "# source: made\n# convention: model\n# persons: 4\n# age: 20-30\n# speed: 1.0-1.4\n"

MOST_BETWEEN_DEG = 0.1
"""Of a curve between points at each 2 % of the cycle."""


def norms_rows(out: Path) -> Iterator[Check]:
    """Persons in the norms, and persons named with the right reason.

    Args:
        out: Folder for the files.
    """
    for seed, name in enumerate((*BELONG, *REASONS), start=1):
        _person(out / "results" / name, name, seed)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = main(
            ["norms", "build", str(out / "results"), "--without", "patient", "--out", str(out / "norms.toml")]
        )
    lines = printed.getvalue().splitlines()
    norms = read_norms(out / "norms.toml")
    yield Check("exit code", code, 0, "<=")
    wrong = set(BELONG) ^ {one.name for one in norms.persons}
    yield Check("persons in the norms that do not belong, or lack", len(wrong), 0, "<=")
    persons = {band.persons for band in norms.curves.values()}
    yield Check("persons of the largest band", max(persons), len(BELONG), "<=")
    named = [
        any(line.startswith(f"left out: {name}") and reason in line for line in lines)
        for name, reason in REASONS.items()
    ]
    yield Check("persons left out and named with the reason", sum(named), len(REASONS), ">=")
    yield from _import_rows(out, norms)


def _import_rows(out: Path, built: Norms) -> Iterator[Check]:
    """Norms as tables of other tools: read back, with other signs and units, and without their convention."""
    own = _imported(out, "own.csv", None)
    apart = [
        max(np.abs(band.mean - own.curves[key].mean).max(), np.abs(band.sd - own.curves[key].sd).max())
        for key, band in built.curves.items()
    ]
    yield Check(
        "norms exported and imported: largest difference of 6 printed digits", float(max(apart)), 0, "<="
    )
    knee = built.curves["walk", "angle", "knee_angle"]
    wide = wide_table("knee extension (rad)", -np.deg2rad(knee.mean), np.deg2rad(knee.sd))
    found = _imported(out, "wide.csv", STATED + wide).curves["walk", "angle", "knee_angle"]
    name = "knee extension in rad, every 2 %, decimal commas: largest difference"
    yield Check(name, float(np.abs(found.mean - knee.mean).max()), MOST_BETWEEN_DEG, "<=", "°")
    refused = 0
    for line in STATED.splitlines(keepends=True):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            (out / "lacks.csv").write_text(STATED.replace(line, "") + wide, encoding="utf-8")
            code = main(["norms", "import", str(out / "lacks.csv"), "--out", str(out / "lacks.toml")])
        refused += code == 2 and line.split(":")[0] in said.getvalue()
    yield Check("imports without one statement refused with its line", refused, STATED.count("#"), ">=")


def _imported(out: Path, name: str, text: str | None) -> Norms:
    """Norms of a table; None: of the built ones' export."""
    with contextlib.redirect_stdout(io.StringIO()):
        if text is None:
            assert main(["norms", "export", str(out / "norms.toml"), "--out", str(out / name)]) == 0
        else:
            (out / name).write_text(text, encoding="utf-8")
        assert main(["norms", "import", str(out / name), "--out", str(out / f"{name}.toml")]) == 0
    return read_norms(out / f"{name}.toml")


def wide_table(title: str, mean: Array, sd: Array) -> str:
    """A wide table of norms with semicolons and decimal commas, every 2 % of the cycle.

    Args:
        title: Of the curve, with its unit.
        mean: (101,) its mean.
        sd: (101,) its standard deviation.
    """
    percent = np.arange(0, 101, 2)
    rows = [
        ";".join(f"{one:.6f}" for one in row).replace(".", ",")
        for row in np.column_stack([percent, mean[::2], sd[::2]])
    ]
    return "\n".join([f"% gait cycle;{title} mean;{title} SD", *rows]) + "\n"


def _person(folder: Path, name: str, seed: int) -> None:
    """The result of one trial, and the session file beside it."""
    motion = "turn" if name == "turner" else "walk"
    subject, made = mbkf.synthesise(
        motion, seconds=None if motion == "turn" else SECONDS, seed=seed, varied=True
    )
    trial = replace(made.trial, plates=())
    if name == "stranger":
        trial = replace(trial, markers=replace(trial.markers, positions_m=1.15 * trial.markers.positions_m))
    settings = mbkf.ReconstructSettings(filter="kinematic")
    result = mbkf.reconstruct(trial, subject, settings=settings)
    write_reconstruction(result, summarise(result), folder / "trial")
    age = None if name == "ageless" else 20.0 + seed
    write_session(SessionNotes(sex="female", age=age), folder / SESSION_FILE)
