"""Whole commands from the shell: `mbkf reconstruct` of a five-second walk."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks.checks import Check, information
from mbkf.errors import InvalidInput
from mbkf.trial.synth import synthesise, write_folder

SECONDS = 5.0
CAUSAL_S, SMOOTHED_S = 1.5, 2.2
RUNS = 5


def rows(folder: Path, runs: int = RUNS) -> list[Check]:
    """Median wall time of the command, causal and smoothed, in turn.

    Args:
        folder: For the capture and the results.
        runs: How often each is run.
    """
    person, recorded = synthesise("walk", seconds=SECONDS)
    written = {path.name: path for path in write_folder(person, recorded, folder)}
    trial = next(path for name, path in written.items() if name.startswith("trial"))
    words = ("reconstruct", trial, "--subject", written["subject.toml"])
    judged = _median_s(words, folder, 1)
    # No laboratory has the truth beside its capture, to which the command compares its result and keeps covariances.
    written["truth.h5"].unlink()
    times = _median_s(words, folder, runs)
    return [
        information("reconstruct of a 5 s walk with its truth, causal, wall time", judged["--causal"], "s"),
        information("… smoothed", judged["--smooth"], "s"),
        Check(
            "reconstruct of a 5 s walk, causal, wall time",
            times["--causal"],
            CAUSAL_S,
            "<=",
            "s",
        ),
        Check("… smoothed", times["--smooth"], SMOOTHED_S, "<=", "s"),
    ]


def _median_s(words: Sequence[str | Path], folder: Path, runs: int) -> dict[str, float]:
    """Median wall time of a command by option.

    Args:
        words: The command.
        folder: For its results.
        runs: How often it is run with each option, in turn.
    """
    times: dict[str, list[float]] = {"--causal": [], "--smooth": []}
    for _ in range(runs):
        for option, taken in times.items():
            taken.append(_seconds(*words, option, "--out", folder / option.strip("-")))
    return {option: float(np.median(taken)) for option, taken in times.items()}


def _seconds(*words: str | Path) -> float:
    """Wall time of a command.

    Raises:
        InvalidInput: It fails.
    """
    command = [sys.executable, "-m", "mbkf", *words]
    begin = perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=as_installed())
    if done.returncode:
        raise InvalidInput(done.stderr.strip().splitlines()[-1])
    return perf_counter() - begin


def as_installed() -> dict[str, str]:
    """Environment of a command that runs as an installed package does: its modules are compiled once and kept."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
