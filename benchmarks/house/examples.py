"""The documentation's examples of a sensor, a loop and a body of one's own, run as a reader runs them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from benchmarks.checks import Check, information
from benchmarks.house.step_files import ROOT, lines_of

EXAMPLES = ROOT / "docs" / "examples"
OWN_BODY, OWN_LOOP, OWN_SENSOR = (
    EXAMPLES / name for name in ("09_own_body.py", "10_own_loop.py", "11_own_sensor.py")
)
BODY = EXAMPLES / "bodies" / "legs.toml"

WITHHELD, INSOLE = "plate withheld", "and insole"
"""What the lines of the own sensor's example begin with."""

TIMEOUT_S = 300.0


class Ran(NamedTuple):
    """A command that has run: whether it ended with 0, and its output."""

    worked: bool
    output: str


def ran(*words: str | Path, folder: Path) -> Ran:
    """Runs Python with these arguments in a folder, this tree first on its path.

    Args:
        words: What follows ``python``.
        folder: Where it runs.
    """
    searched = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    try:
        done = subprocess.run(
            [sys.executable, *map(str, words)],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": searched},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Ran(False, "")
    return Ran(done.returncode == 0, done.stdout + done.stderr)


def error_n(output: str, line: str) -> float:
    """The number before the unit N in the line that begins like that; NaN where there is none."""
    found = re.search(rf"^{re.escape(line)}: .*?([\d.]+) N\b", output, re.MULTILINE)
    return float(found[1]) if found else float("nan")


def sensor_rows(folder: Path) -> list[Check]:
    """Lines of the own sensor, and whether it lowers the error of the plate that was withheld."""
    output = ran(OWN_SENSOR, folder=folder).output
    without, with_insole = error_n(output, WITHHELD), error_n(output, INSOLE)
    return [
        Check("example: own sensor (pressure insole)", lines_of(OWN_SENSOR), 60, "<=", "lines"),
        information("withheld plate's force, without insole", without, "N RMS"),
        Check("withheld plate's force, with insole (bound: without)", with_insole, without, "<=", "N RMS"),
    ]


def loop_rows(folder: Path) -> list[Check]:
    """Lines of the own loop, and whether it runs."""
    return [
        Check("example: own loop", lines_of(OWN_LOOP), 20, "<=", "lines"),
        Check("own loop runs", ran(OWN_LOOP, folder=folder).worked, 1, ">="),
    ]


def body_rows(folder: Path) -> list[Check]:
    """Whether a body from a file outside the package goes through scale, reconstruct and report."""
    lab, result, subject = folder / "lab", folder / "legs", folder / "legs.toml"
    made = _mbkf(["synth", "--motion", "squat", "--seconds", "1.5", "--out", lab], folder)
    (lab / "truth.h5").unlink(missing_ok=True)  # of the whole body
    steps: dict[str, Sequence[str | Path]] = {
        "scale": ["scale", lab / "static.c3d", "--body", BODY, "--out", subject],
        "reconstruct": ["reconstruct", lab / "trial.c3d", "--subject", subject, "--out", result],
        "report": ["report", result],
    }
    return [
        Check(f"own body (legs only): {name}", made and _mbkf(words, folder), 1, ">=")
        for name, words in steps.items()
    ] + [Check("example: own body runs", ran(OWN_BODY, folder=folder).worked, 1, ">=")]


def _mbkf(words: Sequence[str | Path], folder: Path) -> bool:
    return ran("-m", "mbkf", *words, folder=folder).worked
