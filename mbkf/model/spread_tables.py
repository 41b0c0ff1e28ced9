"""Tables of a body file that state how persons differ from the reference body: joint centres, skin, shoulder girdle."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import TomlTable, read_only
from mbkf.errors import FileFormatError, UnknownName
from mbkf.model.description import JointCentre, Segment, SegmentSkin, ShoulderGirdle
from mbkf.model.sides import mirrored

LARGEST_M = 0.1
"""Bound of a spread, m."""


def joint_centres(
    entries: Sequence[TomlTable], segments: Sequence[str], path: Path
) -> tuple[JointCentre, ...]:
    """Spreads of joint centres; that of a right joint is mirrored to the left one, where that exists.

    Args:
        entries: The tables.
        segments: Names of the segments.
        path: The body file.

    Raises:
        UnknownName: A segment does not exist.
        FileFormatError: A spread is impossible.
    """
    found: dict[str, JointCentre] = {}
    for entry in entries:
        segment = _known(entry["segment"], segments, f"{path}, joint_centre")
        sd_m = 1e-3 * np.array(entry["sd_mm"], dtype=float)
        if sd_m.shape != (3,) or not ((sd_m > 0.0) & (sd_m < LARGEST_M)).all():
            raise FileFormatError(
                path,
                f"joint_centre of {segment}: sd_mm needs three positive numbers below {1e3 * LARGEST_M:.0f}",
            )
        for name in (segment, mirrored(segment)):
            if name in segments:
                found.setdefault(name, JointCentre(name, read_only(sd_m)))
    return tuple(found.values())


def segment_skin(entries: Sequence[TomlTable], segments: Sequence[str], path: Path) -> dict[str, SegmentSkin]:
    """Movement of the skin by segment; that of a right segment is mirrored to the left one, where that exists.

    Args: as for :func:`joint_centres`.

    Raises:
        UnknownName: A segment does not exist.
        FileFormatError: A spread is impossible.
    """
    found: dict[str, SegmentSkin] = {}
    for entry in entries:
        segment = _known(entry["segment"], segments, f"{path}, skin")
        where = f"{path}, skin of {segment}"
        flexions = tuple(tuple(_known(joint, segments, where) for joint in one) for one in entry["flexions"])
        sizes = (1e-3 * float(entry["common_mm"]), 1e-3 * float(entry["own_mm"]))
        if not all(flexions) or not 0.0 < min(sizes) <= max(sizes) < LARGEST_M:
            raise FileFormatError(
                path,
                f"skin of {segment}: each flexion needs the names of its joints' distal segments; common_mm and own_mm "
                f"are positive and less than {1e3 * LARGEST_M:.0f}",
            )
        found[segment] = SegmentSkin(segment, flexions, *sizes)
        other = mirrored(segment)
        if other in segments and other != segment:
            turned = tuple(tuple(mirrored(joint) for joint in one) for one in flexions)
            found.setdefault(other, SegmentSkin(other, turned, *sizes))
    return found


def shoulder_girdle(
    entries: Sequence[TomlTable], segments: Sequence[Segment], path: Path
) -> tuple[ShoulderGirdle, ...]:
    """Displacements of the shoulders; that of a right one is mirrored to the left one, where that exists.

    Args:
        entries: The tables.
        segments: The segments.
        path: The body file.

    Raises:
        UnknownName: A segment does not exist.
        FileFormatError: A displacement or spread is impossible, or the joint is not spherical.
    """
    joints = {segment.name: segment.joint for segment in segments}
    found: dict[str, ShoulderGirdle] = {}
    for entry in entries:
        segment = _known(entry["segment"], list(joints), f"{path}, girdle")
        keys = ("mean_mm", "sd_mm", "held_mm")
        mean_m, *spreads = (1e-3 * np.array(entry[key], dtype=float) for key in keys)
        possible = all(one.shape == (3,) and (np.abs(one) < LARGEST_M).all() for one in (mean_m, *spreads))
        if not possible or not all((one > 0.0).all() for one in spreads):
            raise FileFormatError(
                path,
                f"girdle of {segment}: {', '.join(keys)} need three numbers below {1e3 * LARGEST_M:.0f} each, the last "
                "two positive ones",
            )
        if joints[segment] != "spherical":
            raise FileFormatError(path, f"girdle of {segment}: its joint must be spherical")
        for name, turned in ((segment, 1.0), (mirrored(segment), -1.0)):
            if name in joints:
                mirror = np.array([1.0, turned, 1.0])
                found.setdefault(
                    name, ShoulderGirdle(name, read_only(mirror * mean_m), *map(read_only, spreads))
                )
    return tuple(found.values())


def _known(name: str, segments: Sequence[str], where: str) -> str:
    if name not in segments:
        raise UnknownName("segment", name, segments, where)
    return name
