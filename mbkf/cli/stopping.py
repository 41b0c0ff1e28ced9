"""An orderly end by Ctrl-C, SIGTERM or the end of the input; a second Ctrl-C breaks off at once."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def stopped_by_signal() -> Iterator[threading.Event]:
    """Yields an event that Ctrl-C or SIGTERM sets; afterwards both have their earlier handlers."""
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return

    def ask(_number: int, _frame: FrameType | None) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        stop.set()

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_with_input(stop: threading.Event) -> None:
    """Sets an event, from a thread, when the standard input closes: the program at its other end has ended."""

    def watch(number: int) -> None:
        # sys.stdin would not do: a waiting thread holds its lock when Python ends
        while os.read(number, 4096):
            pass
        stop.set()

    threading.Thread(target=watch, args=(sys.stdin.fileno(),), name="mbkf input", daemon=True).start()
