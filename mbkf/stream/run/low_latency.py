"""Settings of the interpreter under which a stream's threads answer in time."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

SWITCH_S = 0.0005
"""How long a thread may keep the interpreter while another one waits; Python's 5 ms would be a frame's whole time."""


@contextmanager
def low_latency() -> Iterator[None]:
    """Inside, threads take turns quickly and the collector leaves alone what was there before."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(usual)
