"""A worker as its parent sees it: a process, and the thread that speaks with it."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import threading
from pathlib import Path
from queue import SimpleQueue

from mbkf.study.batch.outcome import Outcome, Task

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}

PROGRAM = "from mbkf.study.batch.worker import main; main()"

END_S = 1.0
"""Longest wait for the end of a killed process; one that waits for a disk ends when that answers."""

KILLED = "the worker was killed while it did this (out of memory?)"


class Gone:
    """The message that a worker's process has ended."""


class WorkerProcess:
    """A process that does one task after the other.

    Attributes:
        heard: It has sent a message.

    Args:
        inbox: Gets its messages, each with the worker itself: outcomes, progress, signs of life, and its end.

    Raises:
        OSError: The process cannot be started.
    """

    def __init__(self, inbox: SimpleQueue[tuple[WorkerProcess, object]]) -> None:
        self._inbox, self.heard = inbox, False
        paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
        self._process = subprocess.Popen(
            # -P: a file in the current folder that has a library's name is not imported for it
            [sys.executable, "-P", "-c", PROGRAM],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | ONE_THREAD | {"PYTHONPATH": paths},
        )
        self._tasks = SimpleQueue[bytes | None]()
        self._thread = threading.Thread(target=self._speak, name="mbkf-worker", daemon=True)
        self._thread.start()

    def give(self, task: Task) -> None:
        """Hands a task over; returns at once, also where the process has stopped."""
        self._tasks.put(pickle.dumps(task))

    def end(self) -> str:
        """Kills the process; the reason for its end, if it had ended before."""
        code = self._process.poll()
        self._process.kill()
        self._tasks.put(None)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(END_S)
        self._thread.join(END_S)
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None and not self._thread.is_alive():
                with contextlib.suppress(OSError):  # a task that nobody took
                    stream.close()
        return _reason(self._process.returncode if code is None else code)

    def _speak(self) -> None:
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None and stdout is not None
        try:
            while (packed := self._tasks.get()) is not None:
                pickle.dump(packed, stdin)
                stdin.flush()
                message = None
                while not isinstance(message, Outcome):
                    message = pickle.load(stdout)
                    self._inbox.put((self, message))
        except Exception:  # the line is cut, whatever the last bytes were
            self._inbox.put((self, Gone()))


def _reason(code: int | None) -> str:
    """A sentence about the end of a process.

    Args:
        code: Its exit code, or the negative number of the signal that ended it.
    """
    if code is None or code == -getattr(signal, "SIGKILL", 9):
        return KILLED
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        return f"the worker ended by {name} while it did this"
    return f"the worker ended with status {code} while it did this"
