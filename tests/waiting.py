"""Waiting for progress: a test goes on as soon as something has happened, however slow the computer is."""

import time

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
