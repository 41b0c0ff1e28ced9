"""A result as Visual3D's text table: the signals of its C3D file in columns, five lines of heading, a row a frame.

The heading of a column holds the C3D file that Visual3D adds it to, the signal, its type, its folder and the component
(Visual3D documentation, Visual3D ASCII Format). Lengths are m, angles deg, moments N m; a missing value is an empty
field.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.atomic import write_text
from mbkf.io.results import Reconstruction
from mbkf.trial.exchange.result_c3d import result_capture

TYPES = {"angle": "LINK_MODEL_BASED", "moment": "LINK_MODEL_BASED", "power": "LINK_MODEL_BASED"}
"""Types of signals by the kind of a point; forces and places are DERIVED, measured markers TARGET."""

ORIGINAL, FOLDER = "ORIGINAL", "MBKF"
"""Folders of measured markers, and of everything that was computed."""

_DIGITS = 9


class Signal(NamedTuple):
    """A signal: its name, type, folder and components (F, 1 or 3)."""

    name: str
    kind: str
    folder: str
    values: Array


def write_result_v3d(r: Reconstruction, path: str | Path) -> None:
    """Writes the table, for the C3D file of the same name that ``export_result(…, "c3d", …)`` writes.

    Args:
        r: The result.
        path: The file, replaced whole or not at all.

    Raises:
        UnknownName: The subject's body is unknown.
        OSError: The file cannot be written.
    """
    signals = tuple(signals_of(r))
    c3d = f"{Path(path).stem}.c3d"
    names = [(signal, axis) for signal in signals for axis in "XYZ"[: signal.values.shape[1]]]
    heading = [
        ["", *(c3d for _ in names)],
        ["", *(signal.name for signal, _ in names)],
        ["", *(signal.kind for signal, _ in names)],
        ["", *(signal.folder for signal, _ in names)],
        ["ITEM", *(axis for _, axis in names)],
    ]
    table = np.hstack([signal.values for signal in signals])
    rows = ([str(number), *map(_text, row)] for number, row in enumerate(table, start=1))
    write_text(path, "".join("\t".join(line) + "\n" for line in (*heading, *rows)))


def signals_of(r: Reconstruction) -> Iterator[Signal]:
    """Time, measured markers and computed points of a result, at a constant rate."""
    capture = result_capture(r)
    markers = capture.markers
    yield Signal("TIME", "FRAME_NUMBERS", ORIGINAL, markers.times_s[:, None])
    for k, name in enumerate(markers.names):
        yield Signal(name, "TARGET", ORIGINAL, markers.positions_m[:, k])
    for point in capture.derived:
        yield Signal(point.name, TYPES.get(point.kind, "DERIVED"), FOLDER, point.values)


def _text(value: float) -> str:
    return f"{value:.{_DIGITS}g}" if np.isfinite(value) else ""
