"""The process of a worker: tasks come in by its standard input; progress, signs of life and outcomes go out.

While a task is under way, a thread writes a sign of life every second: a worker that is silent for long was stopped.
The process ends as soon as its input closes, which happens also where its parent was killed. Little is imported here,
so that it soon writes its first sign.
"""

from __future__ import annotations

import gc
import os
import pickle
import signal
import threading
import time
from pathlib import Path
from queue import SimpleQueue
from typing import IO

from mbkf.numerics.postponed import postpone
from mbkf.study.batch.progress import Progress

BEAT_S = 1.0
"""Time between two signs of life."""

PROGRESS_S = 0.2
"""Shortest time between two messages about a stage."""

GARBAGE_AFTER = 100_000
"""New objects after which Python looks for circles among them, as in a command: what libraries make stays."""

BEAT = None
"""A sign of life, among the messages."""


class Line:
    """Messages to the parent, each a pickle; threads may send at the same time.

    Args:
        sink: The parent's end of the line.
    """

    def __init__(self, sink: IO[bytes]) -> None:
        self._sink, self._lock = sink, threading.Lock()
        self._progress, self._due_s = Progress(), 0.0

    def send(self, message: object) -> None:
        """Sends a message; ends the process where the parent has gone."""
        with self._lock:
            try:
                pickle.dump(message, self._sink)
                self._sink.flush()
            except OSError:
                os._exit(1)

    def progress(self, stage: str, done: int, total: int) -> None:
        """Sends progress, unless its stage was sent just before.

        Args:
            stage: Name of the stage.
            done: Items done.
            total: Items in all.
        """
        now = time.monotonic()
        if stage != self._progress.stage or now >= self._due_s:
            self._progress, self._due_s = Progress(stage, done, total), now + PROGRESS_S
            self.send(self._progress)


def answer(packed: bytes, line: Line) -> object:
    """The outcome of a task; whatever goes wrong becomes its reason.

    Args:
        packed: The task, pickled.
        line: Where its progress goes.
    """
    try:
        import numpy  # noqa: F401  # first, so that its unused parts can be postponed

        postpone()
        return pickle.loads(packed)(line.progress)
    except BaseException as error:
        from mbkf.study.batch.outcome import failed

        return failed(error)


def main() -> None:
    """Does tasks until the input closes."""
    gc.set_threshold(GARBAGE_AFTER)
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl-C reaches all processes of a terminal; the parent decides
    source, line = os.fdopen(os.dup(0), "rb"), Line(os.fdopen(os.dup(1), "wb"))
    with Path(os.devnull).open() as nothing:
        os.dup2(nothing.fileno(), 0)
    os.dup2(2, 1)  # a library that prints does not disturb the line
    tasks, busy = SimpleQueue[bytes](), threading.Event()
    threading.Thread(target=_receive, args=(source, tasks), name="mbkf-tasks", daemon=True).start()
    threading.Thread(target=_live, args=(line, busy), name="mbkf-beat", daemon=True).start()
    while True:
        packed = tasks.get()
        line.send(BEAT)  # the first one comes before a task that ends or stops the process at once
        busy.set()
        outcome = answer(packed, line)
        busy.clear()
        line.send(outcome)


def _receive(source: IO[bytes], tasks: SimpleQueue[bytes]) -> None:
    """Takes tasks from the parent; ends the process with it."""
    try:
        while True:
            tasks.put(pickle.load(source))
    finally:
        os._exit(1)


def _live(line: Line, busy: threading.Event) -> None:
    """Sends signs of life while a task is under way."""
    while busy.wait():
        line.send(BEAT)
        time.sleep(BEAT_S)
