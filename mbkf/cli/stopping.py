"""An orderly end by Ctrl-C, SIGTERM or the end of the input; a second Ctrl-C breaks off at once.

Commands that compute are broken off (:func:`ended_by_signal`); those that follow a stream or serve a page end by
themselves (:func:`stopped_by_signal`).
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from mbkf.io.leftovers import remove_held

EXIT_INTERRUPTED, EXIT_TERMINATED = 130, 143  # 128 + SIGINT and SIGTERM, as shells report them

END_S = 1.5
"""Longest time from a signal to the end of a command that computes."""

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Terminated(KeyboardInterrupt):
    """The command was asked to end by SIGTERM, or lost its terminal."""


@contextmanager
def ended_by_signal() -> Iterator[None]:
    """Ctrl-C, SIGTERM and the terminal's end raise KeyboardInterrupt, and soon after it the process ends in any case.

    An error that a signal raises is lost where Python is in a callback of a library just then, and is late where a
    library computes for long. So the system also wakes a thread at the signal, which removes the unfinished files of
    this process and ends it, unless it has ended by itself meanwhile. Handlers of a host program stay.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt if number == signal.SIGINT else Terminated

    defaults = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: signal.getsignal(number) for number in SIGNALS if signal.getsignal(number) in defaults}
    woken, waker = socket.socketpair()
    waker.setblocking(False)
    ended = threading.Event()

    def watch() -> None:
        while numbers := woken.recv(1):
            if signal.getsignal(numbers[0]) is interrupt and not ended.wait(END_S):
                _end(EXIT_INTERRUPTED if numbers[0] == signal.SIGINT else EXIT_TERMINATED)

    watching = threading.Thread(target=watch, name="mbkf-end", daemon=True)
    watching.start()
    others = signal.set_wakeup_fd(waker.fileno(), warn_on_full_buffer=False)
    for number in before:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(others)
        for number, handler in before.items():
            signal.signal(number, handler)
        waker.close()
        watching.join()
        woken.close()


def end_within(seconds: float) -> None:
    """Ends the process after a time even if threads are still at work; returns at once.

    Args:
        seconds: The time.
    """

    def end() -> None:
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        _end(0)

    timer = threading.Timer(seconds, end)
    timer.daemon = True
    timer.start()


def _end(code: int) -> None:
    remove_held()
    if code:
        with suppress(OSError):
            os.write(2, b"mbkf: error: interrupted\n")
    os._exit(code)


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

    breaking_off = signal.set_wakeup_fd(-1)
    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(breaking_off)


def stop_with_input(stop: threading.Event) -> None:
    """Sets an event, from a thread, when the standard input closes: the program at its other end has ended."""

    def watch(number: int) -> None:
        # sys.stdin would not do: a waiting thread holds its lock when Python ends
        while os.read(number, 4096):
            pass
        stop.set()

    threading.Thread(target=watch, args=(sys.stdin.fileno(),), name="mbkf input", daemon=True).start()
