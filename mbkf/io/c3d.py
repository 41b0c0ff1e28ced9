"""Reading C3D files: markers, derived points, force plates, analog channels and events in one capture."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.axes import (
    WORLD_AXES,
    axes_text,
    check_body_size,
    length_unit,
    nearest_axis,
    rotation_to_world,
    up_axis,
)
from mbkf.io.c3d_analog import analog_channels, events, plate_readings, raw_plates
from mbkf.io.c3d_decode import C3dContent, decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.c3d_plates import RawPlate, plate_axes
from mbkf.io.c3d_points import read_points
from mbkf.io.c3d_write import write_c3d
from mbkf.io.plausible import MASSES_KG
from mbkf.io.records import AxesSource, Capture
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N

__all__ = ["read_c3d", "write_c3d"]


def read_c3d(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N,
    tare: bool = True,
    plates: bool = True,
) -> Capture:
    """Read a C3D file.

    Positions, forces and moments come out in SI units and world axes (z up), forces as those of the plate on
    the body. Derived points and analog channels stay in the file's own units and axes.

    Args:
        path: The file.
        up: Axis of the file that points up ("x", "-y", "z" …); by default the normal of the force plates
            decides, then POINT:Y_SCREEN, then z.
        unit: Length unit of the file; by default POINT:UNITS, mm where that is empty.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Whether the offset a plate shows without load is removed.
        plates: Whether force plates are read; False for a file whose plates are not usable.

    Returns:
        The capture; its times are the file's own (frame 1 at 0 s).

    Raises:
        FileFormatError: The file is missing, no C3D file, cut short, or a plate is not usable.
        InvalidInput: A force is not a number, or the length unit cannot be right.
        UnknownName: Unknown axis or unit.
    """
    path = Path(path)
    layout = check_layout(path)
    content = decode(path, layout)
    parameters = content.parameters
    rate_hz = _rate(path, content)
    start_s = max(content.first_frame - 1, 0) / rate_hz

    notes = list(content.notes)
    used_unit = _length_unit(path, parameters, unit, notes)
    raw = raw_plates(path, content, used_unit, notes) if plates else []
    used_up, source = (
        (up_axis(up), AxesSource.UP_GIVEN) if up is not None else _up_axis(parameters, raw, notes)
    )
    markers, derived = read_points(content, used_up, used_unit, rate_hz, start_s, notes)
    if unit is None:
        notes += check_body_size(markers.positions_m, used_unit, str(path))
    readings = [
        plate_readings(plate, path, used_unit, used_up, start_s, cop_threshold_n, tare, notes)
        for plate in raw
    ]
    return Capture(
        path=str(path),
        markers=markers,
        plates=tuple(readings),
        derived=derived,
        analog=analog_channels(content),
        events=events(content),
        up_axis=used_up,
        length_unit=used_unit,
        notes=tuple(notes),
        subject_mass_kg=_mass_kg(parameters),
        axes=axes_text(rotation_to_world(used_up)),
        axes_source=source,
        processing=parameters.single_numbers("PROCESSING"),
    )


def _rate(path: Path, content: C3dContent) -> float:
    rate_hz = content.parameters.number("POINT", "RATE") or content.rate_hz
    if not (math.isfinite(rate_hz) and rate_hz > 0.0):
        raise FileFormatError(path, f"POINT:RATE is {rate_hz:g}, not a frame rate; export the trial again")
    return single_precision(rate_hz)


def single_precision(value: float) -> float:
    """The shortest decimal number a 32-bit float stands for: 59.94 instead of 59.939998626708984."""
    return float(str(np.float32(value)))


def _length_unit(path: Path, parameters: C3dParameters, given: str | None, notes: list[str]) -> str:
    if given is not None:
        return length_unit(given)
    stated = parameters.text("POINT", "UNITS")
    if not stated:
        notes.append("POINT:UNITS is empty; lengths taken as mm, the default of C3D")
        return "mm"
    try:
        return length_unit(stated)
    except UnknownName as error:
        reason = f"POINT:UNITS is '{stated}', no unit of length; give it with --unit (mm, cm or m)"
        raise FileFormatError(path, reason) from error


def _up_axis(parameters: C3dParameters, plates: list[RawPlate], notes: list[str]) -> tuple[str, AxesSource]:
    """The axis that points up, from the plates' surfaces, else from the screen axes, else z; and which it was."""
    screen = parameters.text("POINT", "Y_SCREEN").lower().removeprefix("+")
    from_plates = {nearest_axis(-plate_axes(plate.corners)[:, 2]) for plate in plates}
    if len(from_plates) == 1:
        axis = from_plates.pop()
        if screen in WORLD_AXES and screen != axis:
            notes.append(f"force plates face {axis}, POINT:Y_SCREEN is {screen}; taken as up: {axis}")
        return axis, AxesSource.PLATES
    if from_plates:
        notes.append(f"force plates face different axes ({', '.join(sorted(from_plates))})")
    if screen in WORLD_AXES:
        return screen, AxesSource.SCREEN
    notes.append("neither plates nor POINT:Y_SCREEN state which axis points up; taken as z (--up changes it)")
    return "z", AxesSource.DEFAULT


def _mass_kg(parameters: C3dParameters) -> float | None:
    """Body mass stated in PROCESSING or SUBJECTS, if it is one."""
    for group, name in (("PROCESSING", "BODYMASS"), ("SUBJECTS", "BODYMASS"), ("SUBJECTS", "WEIGHT")):
        mass = parameters.number(group, name)
        if MASSES_KG[0] <= mass <= MASSES_KG[1]:
            return single_precision(mass)
    return None
