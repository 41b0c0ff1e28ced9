"""Frame rate of a C3D file, by POINT:RATE, its header, and ANALOG:RATE over the samples per frame."""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.plausible import RATES_HZ

_ALIKE = 2e-3
"""Largest difference of rates that agree, as a share: 59.94 and 60 Hz do."""

ENTRIES = ("POINT:RATE", "its header", "ANALOG:RATE over the samples per frame")
"""The places of a frame rate, the one that holds where all are possible first."""

ANALOG = 2
"""Index of the last one, which counts samples instead of frames: a rate by it alone has a remark."""


def frame_rate(path: Path, stated_hz: float, header_hz: float, analog_hz: float) -> tuple[float, list[str]]:
    """The frame rate in Hz, and a remark where an entry contradicts it.

    The first possible entry that another one confirms holds; without such a pair, the first possible one.

    Args:
        path: The file, for messages.
        stated_hz: POINT:RATE; 0 where it is missing.
        header_hz: Rate of the header.
        analog_hz: ANALOG:RATE over the analog samples per frame; 0 for a file without them.

    Raises:
        FileFormatError: No entry is a possible rate.
    """
    values = (stated_hz, header_hz, analog_hz)
    possible = [i for i, value in enumerate(values) if RATES_HZ[0] <= value <= RATES_HZ[1]]
    if not possible:
        reason = f"POINT:RATE is {stated_hz:g}, its header states {header_hz:g} Hz, and no analog rate helps"
        raise FileFormatError(
            path, f"{reason}; write the frame rate into POINT:RATE, or export the trial again"
        )
    confirmed = [i for i in possible if any(_alike(values[i], values[k]) for k in possible if k != i)]
    chosen = (confirmed or possible)[0]
    rate_hz = values[chosen]
    others = [
        f"{name} {value:g} Hz"
        for i, (name, value) in enumerate(zip(ENTRIES[:ANALOG], values[:ANALOG], strict=True))
        if i != chosen and value and not _alike(value, rate_hz)
    ]
    if not others and chosen < ANALOG:
        return rate_hz, []
    unused = f"; not used: {', '.join(others)}" if others else ""
    return rate_hz, [f"the frame rate is {rate_hz:g} Hz by {ENTRIES[chosen]}{unused}"]


def _alike(one_hz: float, other_hz: float) -> bool:
    return abs(one_hz - other_hz) <= _ALIKE * abs(other_hz)
