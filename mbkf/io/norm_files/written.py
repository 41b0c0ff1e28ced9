"""Norms as a long table (CSV), with source and convention in its comments: what an import reads back."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mbkf.io.atomic import write_text
from mbkf.io.norm_files.raw import MEASURE, NAMES, OWN
from mbkf.io.norms import POINTS, Band, Norms, Speeds
from mbkf.io.written import MARK

HEADS = (
    "kind", "quantity", "curve", "unit", "persons", "speed_from_m_s", "speed_to_m_s", "percent", "mean", "sd",
)  # fmt: skip


def write_norms_table(norms: Norms, path: str | Path) -> None:
    """Writes the bands of norms, to 6 digits as ``norms.toml`` has them, without persons and the basis of the GDI.

    Args:
        norms: They.
        path: The file.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The file cannot be written.
    """
    text = io.StringIO()
    text.write(f"# Norms, {MARK}: a row for each curve and per cent of the gait cycle\n")
    for key, value in _statements(norms):
        text.write(f"# {key}: {value}\n")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(HEADS)
    for speeds, curves in [(None, norms.curves), *norms.by_speed.items()]:
        for (kind, quantity, name), band in curves.items():
            rows.writerows(_rows((kind, quantity, name), band, speeds))
    for (kind, name), band in norms.measures.items():
        rows.writerows(_rows((kind, MEASURE, name), band, None))
    write_text(path, text.getvalue())


def _statements(norms: Norms) -> Iterator[tuple[str, str]]:
    yield "name", norms.name
    persons = max((band.persons for band in norms.curves.values()), default=0)
    yield "source", norms.source or f"persons of {norms.name}"
    yield "convention", norms.convention
    yield "axes", norms.axes
    yield NAMES, OWN
    yield "persons", str(persons)
    for key, span in (("age", norms.ages), ("speed", norms.speeds)):
        if span is not None:
            yield key, f"{span[0]:g}-{span[1]:g}"


def _rows(key: tuple[str, str, str], band: Band, speeds: Speeds | None) -> Iterator[list[str]]:
    span = ["", ""] if speeds is None else [f"{one:g}" for one in speeds]
    percent = [""] if len(band.mean) == 1 else [f"{one:g}" for one in np.linspace(0.0, 100.0, POINTS)]
    for place, mean, sd in zip(percent, band.mean, band.sd, strict=True):
        yield [*key, band.unit, str(band.persons), *span, place, f"{mean:.6g}", f"{sd:.6g}"]
