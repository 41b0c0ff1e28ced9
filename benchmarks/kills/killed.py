"""An mbkf command that kills itself right before one of the steps that it takes with files.

    python -m benchmarks.kills.killed FOLDER STEP ARGUMENTS...

A step is what Python tells its audit hooks of paths in FOLDER: to open for writing, make, rename, link or remove.
STEP 0 kills nothing and prints how many there were.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from mbkf.cli.main import main

STEPS = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.symlink", "os.truncate", "open"}
EXCHANGES = {("ctypes.dlsym", "renameat2"), ("ctypes.dlsym", "renamex_np")}
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT


class Steps:
    """Counts steps and kills at one of them."""

    def __init__(self, folder: Path, at: int) -> None:
        self.folder, self.at, self.count = str(folder), at, 0

    def __call__(self, event: str, args: tuple[object, ...]) -> None:
        """Counts an event, and kills at it."""
        if not self.is_step(event, args):
            return
        self.count += 1
        if self.count == self.at:
            os.kill(os.getpid(), signal.SIGKILL)

    def is_step(self, event: str, args: tuple[object, ...]) -> bool:
        """Whether an event changes something in the folder."""
        if event == "ctypes.dlsym":
            return (event, args[1]) in EXCHANGES
        if event not in STEPS or not isinstance(args[0], str | bytes | os.PathLike):
            return False
        if event == "open" and not (isinstance(args[2], int) and args[2] & WRITES):
            return False
        # Where shutil.rmtree removes relative to an open folder, paths are bare names.
        path = os.fsdecode(args[0])
        return not Path(path).is_absolute() or path.startswith(self.folder)


def run(words: list[str]) -> int:
    """Runs the command."""
    folder, at, *arguments = words
    steps = Steps(Path(folder), int(at))
    sys.addaudithook(steps)
    code = main(arguments)
    if steps.at == 0:
        print(f"steps {steps.count}")
    return code


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
