"""One door to all capture files: chooses the reader by the suffix and joins ground reactions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.c3d import read_c3d
from mbkf.io.forces import read_forces_mot
from mbkf.io.records import Capture
from mbkf.io.trc import read_trc
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N

SUFFIXES = (".c3d", ".trc")
"""Capture files that can be read."""


def read_capture(
    path: str | Path,
    *,
    forces: str | Path | None = None,
    up: str | None = None,
    unit: str | None = None,
    cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N,
    tare: bool = True,
) -> Capture:
    """Read a capture, and its ground reactions where they stand in a file of their own.

    Args:
        path: C3D or TRC file.
        forces: MOT file of ground reactions; it then replaces the plates of a C3D file. Its y is up, or
            ``up`` where the markers are a TRC file. It keeps its own times.
        up: Axis of the file that points up; by default what a C3D file says, y for a TRC file.
        unit: Length unit of the markers; by default what the file says.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Whether the offset an unloaded plate shows is removed.

    Returns:
        The capture in SI units and world axes.

    Raises:
        FileFormatError: A file is missing, of an unknown kind, or broken.
        InvalidInput: A force is not a number, or the length unit cannot be right.
        UnknownName: Unknown axis, unit, or naming of force columns.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        reason = f"'{path.suffix}' files cannot be read as captures; name a {' or '.join(SUFFIXES)} file"
        raise FileFormatError(path, reason)
    if suffix == ".trc":
        capture = read_trc(path, up=up or "y", unit=unit)
        force_up = up or "y"
    else:
        capture = read_c3d(
            path, up=up, unit=unit, cop_threshold_n=cop_threshold_n, tare=tare, plates=forces is None
        )
        force_up = "y"
    if forces is None:
        return capture
    plates = read_forces_mot(forces, up=force_up, cop_threshold_n=cop_threshold_n, tare=tare)
    notes = [*capture.notes, f"ground reactions from {Path(forces).name}"]
    markers = capture.markers
    end_s = markers.start_time_s + markers.frames / markers.rate_hz
    for plate in plates:
        if plate.times_s[-1] < markers.start_time_s or plate.start_time_s > end_s:
            notes.append(f"ground reactions of '{plate.name}' lie outside the time of the markers")
        if plate.offset[2]:
            notes.append(f"set '{plate.name}': offset of {plate.offset[2]:+.1f} N vertical force removed")
    return replace(capture, plates=plates, notes=tuple(notes))
