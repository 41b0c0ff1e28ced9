"""Levels of the spine from the tables of a body file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, TomlTable, read_only
from mbkf.errors import FileFormatError, UnknownName
from mbkf.model.description import Segment, TrunkLevel

_MM = 1e-3


def trunk_levels(
    entries: Sequence[TomlTable], segments: Sequence[Segment], path: Path
) -> tuple[TrunkLevel, ...]:
    """The levels of a body.

    Args:
        entries: Tables ``[[level]]``.
        segments: The body's segments.
        path: The file, for error messages.

    Raises:
        UnknownName: A level names a segment that does not exist.
        FileFormatError: A level cannot be: its numbers, its place among the segments, or its name twice.
    """
    found = tuple(_level(entry, segments, path) for entry in entries)
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise FileFormatError(path, f"two levels are named {name}; give every level its own name")
    return found


def _level(entry: TomlTable, segments: Sequence[Segment], path: Path) -> TrunkLevel:
    name, where = entry["name"], f"level {entry['name']}"
    by_name = {segment.name: segment for segment in segments}
    if entry["above"] not in by_name:
        raise UnknownName("segment", entry["above"], by_name, f"{path}, {where}")
    trunk, root = by_name[entry["above"]], segments[0]
    if trunk.parent != root.name or trunk.joint != "spherical":
        raise FileFormatError(
            path,
            f"{where}: 'above' must name a segment with a spherical joint on the root {root.name}, not {trunk.name}",
        )

    def three(key: str, factor: float = 1.0) -> Array:
        numbers = np.array(entry.get(key, [0.0, 0.0, 0.0]), dtype=float)
        if numbers.shape != (3,) or not np.isfinite(numbers).all():
            raise FileFormatError(path, f"{where}: {key} needs three finite numbers")
        return read_only(factor * numbers)

    return TrunkLevel(
        name,
        trunk.name,
        three("position_m") if "position_m" in entry else None,
        three("sd_mm", _MM),
        float(entry.get("part_mass_kg", 0.0)),
        three("part_com_m"),
        three("part_inertia_kg_m2"),
        entry.get("opensim", ""),
    )
