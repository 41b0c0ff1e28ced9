"""Standard streams that the caller closed (`mbkf info walk.c3d >&-`): they lead nowhere instead.

A closed number would be given to the next file that is opened, and text meant for the terminal would go into it.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

STREAMS = 3
"""Numbers of standard input, output and error: 0, 1, 2."""


def open_closed_streams() -> None:
    """Opens the null device in the place of each standard stream that is closed."""
    for number in range(STREAMS):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 (open until the end)
