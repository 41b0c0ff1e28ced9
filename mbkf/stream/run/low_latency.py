"""Low-latency mode of the Python interpreter: short thread switches, and no garbage collection of older objects."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

SWITCH_S = 0.0005
"""Longest time a thread keeps the interpreter while another one waits; Python's default of 5 ms is a whole frame."""


@contextmanager
def low_latency() -> Iterator[None]:
    """Low-latency mode inside the block: threads switch quickly, and existing objects are not garbage-collected.

    A program that froze objects before keeps them as they are: Python can unfreeze only all of them at once.
    """
    usual, unfrozen = sys.getswitchinterval(), gc.get_freeze_count() == 0
    sys.setswitchinterval(SWITCH_S)
    if unfrozen:
        gc.collect()
        gc.freeze()
    try:
        yield
    finally:
        if unfrozen:
            gc.unfreeze()
        sys.setswitchinterval(usual)
