"""Processor time and peak memory of a command, as the operating system counts them, start-up included.

Linux counts the memory of the process that starts a command as the command's own, so that a small process starts it.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from benchmarks.speed.commands import as_installed
from mbkf.errors import InvalidInput

_START = """\
import resource, subprocess, sys
code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss)
sys.exit(code)
"""


class Consumed(NamedTuple):
    """Processor time of a process with that of its own children, s, and its peak memory, MB."""

    seconds: float
    peak_mb: float


def consumed(*words: str | Path) -> Consumed:
    """Runs ``mbkf`` with these words in a process of its own.

    Raises:
        InvalidInput: It fails.
    """
    command = [sys.executable, "-c", _START, sys.executable, "-m", "mbkf", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=as_installed())
    if done.returncode:
        raise InvalidInput(done.stderr.strip().splitlines()[-1])
    seconds, peak = map(float, done.stdout.split())
    unit = 1.0 if sys.platform == "darwin" else 1024.0  # the system counts bytes or kilobytes
    return Consumed(seconds, peak * unit / 1e6)
