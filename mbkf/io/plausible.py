"""Readings that no laboratory measures: far markers count as missing, impossible forces are refused.

A damaged number, a wrong scale or an unsigned offset read with a sign gives places of a thousand kilometres and forces
of tons; one such sample carries a filter away.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.records import Capture

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
    """The capture with markers outside of any laboratory as missing, which a remark counts.

    ``forces`` is the file of its plates, where they have one of their own.

    Raises:
        InvalidInput: A frame rate, a force, a moment or the place of a plate is impossible.
    """
    markers, rates = capture.markers, {"the markers": capture.markers.rate_hz}
    rates |= {f"force plate {plate.name}": plate.rate_hz for plate in capture.plates}
    for name, rate_hz in rates.items():
        if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
            file = forces if forces is not None and name != "the markers" else capture.path
            raise InvalidInput(f"{file}: the rate of {name} is {rate_hz:g} Hz; export the trial again")
    for plate in capture.plates:
        for quantity, values, most, unit in (
            ("force", plate.force_n, MOST_N, "N"),
            ("moment", plate.moment_nm, MOST_NM, "N m"),
        ):
            largest = float(np.max(np.abs(values), initial=0.0))
            if not largest <= most:
                raise InvalidInput(
                    f"{forces or capture.path}: force plate {plate.name} reads a {quantity} of {largest:.2g} {unit}; "
                    "check its scale and offset (ANALOG:SCALE, OFFSET), or give the ground reactions with --forces"
                )
        places = plate.origin_m if plate.corners_m is None else np.vstack([plate.origin_m, plate.corners_m])
        if not (np.abs(places) <= FARTHEST_M).all():
            raise InvalidInput(
                f"{forces or capture.path}: force plate {plate.name} lies more than {FARTHEST_M:g} m away; check "
                "its corners and points, or their unit"
            )
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
