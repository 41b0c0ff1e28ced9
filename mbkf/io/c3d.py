"""Reading C3D files: markers, derived points, force plates, analog channels and events in one capture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mbkf.io.axes import (
    WORLD_AXES,
    axes_text,
    check_body_size,
    nearest_axis,
    rotation_to_world,
    up_axis,
)
from mbkf.io.c3d_analog import analog_channels, events, plate_readings, raw_plates
from mbkf.io.c3d_decode import C3dContent, decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.c3d_person import stated_mass
from mbkf.io.c3d_plates import RawPlate
from mbkf.io.c3d_points import read_points
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.marker_capture import StatedUnit
from mbkf.io.plate_corners import plate_normal
from mbkf.io.readable_plates import readable_plates
from mbkf.io.records import AxesSource, Capture


def read_c3d(path: str | Path, options: CaptureOptions) -> Capture:
    """Read a C3D file.

    Positions, forces and moments come out in SI units and world axes (z up), forces as those of the plate on
    the body. Derived points and analog channels stay in the file's own units and axes. Times are the file's own
    (frame 1 at 0 s). Without an axis in the options the normal of the force plates points up, else POINT:Y_SCREEN,
    else z; without a unit POINT:UNITS holds, mm where that is empty. A plate that cannot be read is left out, with a
    remark.

    Raises:
        FileFormatError: The file is missing, no C3D file, cut short, or states no frame rate.
        InvalidInput: The length unit cannot be right.
        UnknownName: Unknown axis or unit.
    """
    path = Path(path)
    return capture_of(path, decode(path, check_layout(path)), options)


def capture_of(path: Path, content: C3dContent, options: CaptureOptions, first: int = 0) -> Capture:
    """The capture that a decoded file, or a part of one, makes.

    Args:
        path: The file.
        content: Its content.
        options: Options of the reader.
        first: The part's first frame, counted from 0; it begins later by so much.

    Raises:
        FileFormatError: The file states no frame rate.
        InvalidInput: The length unit cannot be right.
        UnknownName: Unknown axis or unit.
    """
    parameters = content.parameters
    mass_kg = stated_mass(parameters)
    rate_hz = single_precision(content.rate_hz)
    start_s = (max(content.first_frame - 1, 0) + first) / rate_hz

    notes = list(content.notes)
    stated = StatedUnit("POINT:UNITS", parameters.text("POINT", "UNITS"), "mm")
    unit = stated.of(path, options, notes)
    raw = raw_plates(path, content, unit, options, notes) if options.plates else []
    if options.up is None:
        up, source = _up_axis(parameters, raw, notes)
    else:
        up, source = up_axis(options.up), AxesSource.UP_GIVEN
    markers, derived = read_points(content, up, unit, rate_hz, start_s, notes)
    if options.unit is None:
        notes += check_body_size(markers.positions_m, unit, str(path))
    plates = readable_plates(
        ((str(plate.number), plate) for plate in raw),
        lambda plate: plate_readings(plate, path, unit, up, start_s, options, notes),
        options,
        str(path),
        needs_one=False,
    )
    instants = events(content, notes)
    return Capture(
        path=str(path),
        markers=markers,
        plates=tuple(plates),
        derived=derived,
        analog=analog_channels(content),
        events=instants,
        up_axis=up,
        length_unit=unit,
        notes=tuple(notes),
        subject_mass_kg=None if mass_kg is None else single_precision(mass_kg),
        axes=axes_text(rotation_to_world(up)),
        axes_source=source,
        processing=parameters.single_numbers("PROCESSING"),
    )


def single_precision(value: float) -> float:
    """The shortest decimal number a 32-bit float stands for: 59.94 instead of 59.939998626708984."""
    return float(str(np.float32(value)))


def _up_axis(parameters: C3dParameters, plates: list[RawPlate], notes: list[str]) -> tuple[str, AxesSource]:
    """The axis that points up, from the plates' surfaces, else from the screen axes, else z; and which it was."""
    screen = parameters.text("POINT", "Y_SCREEN").lower().removeprefix("+")
    from_plates = {nearest_axis(plate_normal(plate.corners.T)) for plate in plates}
    if len(from_plates) == 1:
        axis = from_plates.pop()
        if screen in WORLD_AXES and screen != axis:
            notes.append(f"force plates face {axis}, POINT:Y_SCREEN is {screen}; taken as up: {axis}")
        return axis, AxesSource.PLATES
    if from_plates:
        notes.append(f"force plates face different axes ({', '.join(sorted(from_plates))})")
    if screen in WORLD_AXES:
        return screen, AxesSource.SCREEN
    notes.append(
        "neither plates nor POINT:Y_SCREEN state the axis that points up; taken as z (--up changes it)"
    )
    return "z", AxesSource.DEFAULT
