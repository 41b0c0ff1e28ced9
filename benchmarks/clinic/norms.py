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

import mbkf
from benchmarks.checks import Check
from mbkf.cli.main import main
from mbkf.io.norms import read_norms
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
