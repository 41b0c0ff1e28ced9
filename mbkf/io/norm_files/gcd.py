"""GCD files of Vicon Clinical Manager and Polygon: a variable's name, then mean and standard deviation in each row.

The first line names the format. A line "!HipFlexExt 3" begins a variable; 51 rows are the cycle in steps of 2 %, one
row is a parameter. The format has no units; those of the files known are deg, N m/kg and W/kg.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.raw import RawBand, RawNorms
from mbkf.io.text import numbers

FORM = "GCD file"

HEADING = "#!DST"
"""Begins the first line."""

END = "\x1a \r\n"
"""Ends files of DOS programs."""


def gcd_norms(path: Path, text: str) -> RawNorms:
    """The bands of a file; parameters of one row are left out, since their units are not known.

    Args:
        path: The file, for messages.
        text: Its text.

    Raises:
        FileFormatError: A row has not two numbers.
    """
    found: dict[str, list[list[float]]] = {}
    rows: list[list[float]] | None = None
    for line, content in enumerate(text.rstrip(END).splitlines(), start=1):
        words = content.split()
        if content.startswith("!") and len(content) > 1 and words:
            name = words[0][1:]
            if name in found:
                raise FileFormatError(path, f"{name} stands twice; keep one of both", line)
            rows = found.setdefault(name, [])
        elif words and rows is not None and not content.startswith(("#", "$")):
            pair = numbers(words, path, line)
            if len(pair) != 2:
                raise FileFormatError(path, f"{len(pair)} numbers for mean and spread", line)
            rows.append(pair)
    bands = []
    for name, values in found.items():
        if len(values) > 1:
            mean, sd = np.array(values).T
            unit = "N m/kg" if name.endswith("Moment") else "W/kg" if name.endswith("Power") else "deg"
            bands.append(RawBand(name, mean, sd, np.linspace(0.0, 100.0, len(mean)), unit=unit))
    return RawNorms(FORM, tuple(bands))
