"""Writes that fail as on a full disk: a small library in front of the system's calls, or a small disk in memory."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mbkf.errors import MbkfError

SOURCE = Path(__file__).with_suffix(".c")


class NotHere(MbkfError):
    """This computer or user cannot do this; the message says why."""


@dataclass(frozen=True)
class FailingWrites:
    """The library, compiled.

    Attributes:
        library: Its file.
    """

    library: Path

    @property
    def environment(self) -> dict[str, str]:
        """Variables of a process that has it in front of its calls."""
        return {**os.environ, "LD_PRELOAD": str(self.library)}

    def fault(self, folder: Path, at: int, lasting: bool = True) -> dict[str, Any]:
        """Writes that fail.

        Args:
            folder: Of the files below it.
            at: The first write that fails, from 1; 0 counts only.
            lasting: All later ones fail, too, as on a disk that stays full.
        """
        return {"library": str(self.library), "folder": str(folder), "at": at, "lasting": lasting}


def failing_writes(folder: Path) -> FailingWrites:
    """Compiles the library into a folder.

    Raises:
        NotHere: This is not Linux, or there is no C compiler.
    """
    compiler = shutil.which("cc")
    if compiler is None or not sys.platform.startswith("linux"):
        raise NotHere("it needs Linux and a C compiler called cc")
    library = folder / "failing_writes.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", library, SOURCE, "-ldl"], check=True)
    return FailingWrites(library)


@contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Path]:
    """A disk in memory, mounted at a folder while the block runs.

    Args:
        folder: Where it is mounted; made where missing.
        kilobytes: Its size.

    Raises:
        NotHere: This user may not mount one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    words = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise NotHere("this system lacks the command mount") from None
    if done.returncode:
        raise NotHere(f"this user may not mount a disk in memory ({done.stderr.strip()})")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)  # workers of a batch may still end
