"""Waiting for progress: a test goes on as soon as something has happened, however slow the computer is."""

import threading
import time
from contextlib import contextmanager

PATIENCE_S = 300.0
"""What has not happened by then hangs; no test depends on it otherwise."""

LOOK_S = 0.02


def until(condition, seen=lambda: ""):
    """Waits for a condition and returns its value, which is true.

    Args:
        condition: Called again and again.
        seen: Called for the message of a failure.
    """
    ends = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        assert time.monotonic() < ends, f"it never happened: {seen()}"
        time.sleep(LOOK_S)
    return found


@contextmanager
def repeating(step, period_s=0.001):
    """Calls a function every so often in a thread, as a sender does, until the block ends."""
    done = threading.Event()

    def repeat():
        while not done.wait(period_s):
            step()

    thread = threading.Thread(target=repeat)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
