"""Start of commands: `mbkf live` until it listens, `mbkf reconstruct` until it has answered its first frame.

Modules are compiled and files read by a run before. Each command ends as soon as it has come so far; processor time is
that of the operating system's account.
"""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from benchmarks.checks import Check
from benchmarks.speed.commands import as_installed
from mbkf.errors import InvalidInput
from mbkf.trial.synth import synthesise, write_folder

SECONDS, RUNS = 4.0, 7
FIRST_FRAME_S, LISTENING_S = 0.5, 0.7
LISTENING, ANSWERED = "waiting for", "answered"

FIRST_FRAME = f"""\
import os, sys
from contextlib import contextmanager
from mbkf.cli import progress

@contextmanager
def stages():
    yield lambda *_: (os.write(2, b"{ANSWERED}\\n"), os._exit(0))

progress.stages = stages
from mbkf.__main__ import main
main()
"""
"""The command `mbkf`, which ends when the first frame is reported as done."""


class Started(NamedTuple):
    """Processor time and wall time until a command has come so far, s."""

    processor_s: float
    wall_s: float


def rows(folder: Path, runs: int = RUNS) -> list[Check]:
    """Both commands, in turn; medians.

    Args:
        folder: For the capture.
        runs: How often each is run.
    """
    write_folder(*synthesise("walk", seconds=SECONDS), folder)
    subject, trial = ("--subject", folder / "subject.toml"), folder / "trial.c3d"
    (folder / "truth.h5").unlink()
    live = (*("-m", "mbkf", "live", "--from", "udp:0"), *subject, "--out", folder / "live")
    first = ("-c", FIRST_FRAME, "reconstruct", trial, *subject, "--out", folder / "result")
    until = {LISTENING: live, ANSWERED: first}
    times: dict[str, list[Started]] = {said: [] for said in until}
    for _ in range(runs + 1):
        for said, words in until.items():
            times[said].append(started(words, said))
    (heard, heard_wall), (answered, answered_wall) = (np.median(times[said][1:], axis=0) for said in until)
    return [
        Check("live until it listens, processor time", heard, LISTENING_S, "<=", "s"),
        Check("… wall time", heard_wall, LISTENING_S, "<=", "s"),
        Check("reconstruct until its first frame, processor time", answered, FIRST_FRAME_S, "<=", "s"),
        Check("… wall time", answered_wall, FIRST_FRAME_S, "<=", "s"),
    ]


def started(words: Sequence[str | Path], said: str) -> Started:
    """Runs Python with these words until a line on its standard error begins with a text.

    Raises:
        InvalidInput: It ended before.
    """
    before, begin = _used_s(), perf_counter()
    with subprocess.Popen(
        [sys.executable, *map(str, words)], stderr=subprocess.PIPE, text=True, env=as_installed()
    ) as process:
        assert process.stderr is not None
        lines = []
        for line in process.stderr:
            lines.append(line.strip())
            if line.startswith(said):
                break
        else:
            raise InvalidInput(f"mbkf ended before '{said}': {' '.join(lines)}")
        wall_s = perf_counter() - begin
        process.kill()
    return Started(_used_s() - before, wall_s)


def _used_s() -> float:
    """Processor time of the processes that this one has started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
