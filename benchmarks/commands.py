"""Runs commands of `mbkf` as a user would, and reads the files they write."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from mbkf.cli.main import main
from mbkf.errors import MbkfError
from mbkf.io.results_folder import Summary, read_summary
from mbkf.io.storage import Table, read_storage


@dataclass(frozen=True)
class Written:
    """Files written by `mbkf reconstruct`: summary, angles, torques; and the wall time of the commands."""

    summary: Summary
    angles: Table
    torques: Table
    seconds: float


@dataclass(frozen=True)
class Ended:
    """End of a command: its exit code, and the text on standard output and standard error."""

    code: int
    out: str
    err: str

    @property
    def text(self) -> str:
        """All that was printed."""
        return self.out + self.err


FILTER = ("--filter", "kinematic")
"""The main job's bounds are those of the marker filter followed by inverse dynamics."""


def mbkf(*words: str | Path, fresh: bool = False) -> float:
    """Runs one command quietly.

    Args:
        words: What follows ``mbkf``.
        fresh: Whether in a process of its own, with its start counted in the time.

    Returns:
        Wall time in s.

    Raises:
        MbkfError: The command did not end with 0; its message.
    """
    arguments = [str(word) for word in words]
    start = perf_counter()
    code, message = _in_process_of_its_own(arguments) if fresh else _here(arguments)
    if code:
        raise MbkfError(f"mbkf {arguments[0]} ended with {code}: {message.strip()}")
    return perf_counter() - start


def typed(*words: str | Path) -> Ended:
    """Runs one command in this process and keeps what it prints.

    Args:
        words: What follows ``mbkf``.
    """
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(bool(end.code))
    return Ended(code, out.getvalue(), err.getvalue())


def read_folder(folder: Path, seconds: float = 0.0) -> Written:
    """Reads a reconstruction's folder."""
    angles, torques = (read_storage(folder / name) for name in ("angles.mot", "torques.sto"))
    return Written(read_summary(folder), angles, torques, seconds)


def scale_and_reconstruct(
    trial: Path,
    scaling: Sequence[str | Path],
    folder: Path,
    *,
    forces: Path | None = None,
    fresh: bool = False,
) -> Written:
    """The main job with default settings: scale, then reconstruct.

    Args:
        trial: The capture to track.
        scaling: Words for ``mbkf scale`` but ``--out``.
        folder: Where everything goes.
        forces: Ground reactions that are no part of the trial.
        fresh: Whether each command gets a process of its own.
    """
    subject = folder / "subject.toml"
    seconds = mbkf("scale", *scaling, "--out", subject, fresh=fresh)
    with_forces = () if forces is None else ("--forces", forces)
    seconds += mbkf(
        "reconstruct", trial, "--subject", subject, *with_forces, *FILTER, "--out", folder, fresh=fresh
    )
    return read_folder(folder, seconds)


def _here(arguments: list[str]) -> tuple[int, str]:
    ended = typed(*arguments)
    return ended.code, ended.err


def _in_process_of_its_own(arguments: list[str]) -> tuple[int, str]:
    words = [sys.executable, "-m", "mbkf", *arguments]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr
