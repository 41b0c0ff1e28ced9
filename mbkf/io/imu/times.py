"""Times of samples in seconds, whatever a file counts them in."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.units import UNITS

_LEAST_STEPS = {"s": 2e-4, "ms": 0.2, "us": 200.0, "ns": 2e5}
"""Steps of clocks that count in a unit, at rates of 5 to 5000 Hz: each begins where the one before ends."""

_COUNTER_TURN = 2.0**32


def times_s(path: Path, counted: Array, unit: str, title: str) -> Array:
    """(T,) seconds.

    A step between samples shows the unit of a clock that does not state it: at rates of 5 to 5000 Hz no step is
    possible in two of the units. A clock that counts one by one from 0 or 1 may be a counter of samples.

    Args:
        path: The file, for messages.
        counted: (T,) the clock's readings; a 32-bit counter that turned over goes on.
        unit: Its unit, a key of :data:`mbkf.io.imu.units.UNITS` under "time", or "".
        title: Its name, for messages.

    Raises:
        InvalidInput: The unit is not stated, and the steps leave it open.
    """
    steps = np.diff(counted)
    turned = steps < -0.5 * _COUNTER_TURN
    if turned.any():
        counted = counted + _COUNTER_TURN * np.concatenate([[0.0], np.cumsum(turned)])
        steps = np.diff(counted)
    return UNITS["time"][unit or _unit_of_steps(path, counted, steps, title)] * counted


def _unit_of_steps(path: Path, counted: Array, steps: Array, title: str) -> str:
    known = steps[np.isfinite(steps) & (steps > 0.0)]
    step = float(np.median(known)) if len(known) else 0.0
    if step == 1.0 and counted[0] in (0.0, 1.0) and len(counted) > 2:
        raise InvalidInput(
            f"{path}: column '{title}' counts one by one; if it counts samples give the rate with --rate, if "
            "milliseconds --units time=ms"
        )
    if step < _LEAST_STEPS["s"]:
        return "s"
    return [unit for unit, least in _LEAST_STEPS.items() if step >= least][-1]
