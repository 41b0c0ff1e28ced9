"""Readings that no laboratory measures: far markers count as missing, plates with impossible forces are left out.

A damaged number, a wrong scale or an unsigned offset read with a sign gives places of a thousand kilometres and forces
of tons; one such sample carries a filter away.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.readable_plates import left_out_notes, readable_plates
from mbkf.io.records import Capture, PlateReadings

FARTHEST_M = 1000.0
"""Size of the largest laboratory or track."""

MOST_N, MOST_NM = 1e5, 1e5
"""Plates for persons end at a fifth of this."""

RATES_HZ = (0.5, 1e5)
"""Frame rates that cameras, plates and sensors have."""

MASSES_KG = (0.5, 500.0)
"""Body masses that a file may state."""

_NAMED = 3


def plausible(capture: Capture, forces: Path | None = None) -> Capture:
    """The capture with markers outside of any laboratory as missing, and without impossible plates, with remarks.

    ``forces`` is the file of its plates, where they have one of their own.

    Raises:
        InvalidInput: A frame rate is impossible, or the force, moment or place of all plates of ``forces``.
    """
    markers, rates = capture.markers, {"the markers": capture.markers.rate_hz}
    rates |= {f"force plate {plate.name}": plate.rate_hz for plate in capture.plates}
    for name, rate_hz in rates.items():
        if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
            file = forces if forces is not None and name != "the markers" else capture.path
            raise InvalidInput(f"{file}: the rate of {name} is {rate_hz:g} Hz; export the trial again")
    capture = _possible_plates(capture, forces)
    far = np.abs(markers.positions_m).max(axis=2, initial=0.0) > FARTHEST_M
    if not far.any():
        return capture
    names = [name for name, any_ in zip(markers.names, far.any(axis=0), strict=True) if any_]
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    remark = (
        f"{int(far.sum())} samples lie more than {FARTHEST_M:g} m away and are taken as missing: "
        f"{', '.join(names[:_NAMED])}{more}"
    )
    positions = np.where(far[:, :, None], np.nan, markers.positions_m)
    return replace(capture, markers=replace(markers, positions_m=positions), notes=(*capture.notes, remark))


def _possible_plates(capture: Capture, forces: Path | None) -> Capture:
    """The capture without plates whose readings or places are impossible.

    Raises:
        InvalidInput: All plates of ``forces`` are impossible.
    """
    options = CaptureOptions(left_out=dict(capture.plates_left_out))
    file = str(forces or capture.path)
    named = [(plate.name, plate) for plate in capture.plates]
    plates = readable_plates(
        named, lambda plate: _possible(plate, file), options, file, needs_one=forces is not None
    )
    if len(plates) == len(capture.plates):
        return capture
    new = {name: why for name, why in options.left_out.items() if name not in capture.plates_left_out}
    notes = (*capture.notes, *left_out_notes(new))
    return replace(capture, plates=tuple(plates), plates_left_out=options.left_out, notes=notes)


def _possible(plate: PlateReadings, file: str) -> PlateReadings:
    """The plate.

    Raises:
        InvalidInput: A force, a moment or its place is impossible.
    """
    for quantity, values, most, unit in (
        ("force", plate.force_n, MOST_N, "N"),
        ("moment", plate.moment_nm, MOST_NM, "N m"),
    ):
        largest = float(np.max(np.abs(values), initial=0.0))
        if not largest <= most:
            raise InvalidInput(
                f"{file}: force plate {plate.name} reads a {quantity} of {largest:.2g} {unit}; "
                "check its scale and offset (ANALOG:SCALE, OFFSET), or give the ground reactions with --forces"
            )
    places = plate.origin_m if plate.corners_m is None else np.vstack([plate.origin_m, plate.corners_m])
    if not (np.abs(places) <= FARTHEST_M).all():
        raise InvalidInput(
            f"{file}: force plate {plate.name} lies more than {FARTHEST_M:g} m away; check "
            "its corners and points, or their unit"
        )
    return plate
