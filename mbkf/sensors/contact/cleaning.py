"""Plates cleaned of impossible readings: short gaps are bridged, longer ones are not measured.

A gap of up to :data:`BRIDGED_S` is bridged by straight lines. In a longer one the plate was not recorded (NaN): the
filters then estimate the reaction of a foot that stands there, as of any foot without a plate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, BoolArray
from mbkf.io.plate_corners import plate_normal
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import centre_of_pressure
from mbkf.numerics.runs import runs
from mbkf.sensors.contact.faults import NO_FAULT, bridged, faults_of
from mbkf.sensors.contact.possible import Fault, Faults, reaches

BRIDGED_S = 0.025
"""Longest gap that straight lines bridge. Ground reactions of gait hold little above 10 Hz (0.2 body weights), which
such a line misses by 0.06 body weights at most."""

MOST_PASSES = 5
"""A refused sample may uncover another; more than two passes were never needed."""

NAMED_STRETCHES = 3
"""Number of stretches of one kind that are named with their times."""

WORDS = {
    Fault.NOT_A_NUMBER: "missing or not numbers",
    Fault.FORCE: "with a force beyond 20 body weights",
    Fault.PULL: "pulling the body down",
    Fault.SHEAR: "with shear beyond any friction",
    Fault.MOMENT: "pressing far outside the plate",
    Fault.SPIKE: "in a spike faster than any foot's",
    Fault.DROPOUT: "zero under a standing foot",
    Fault.SATURATED: "cut off at the converter's limit",
    Fault.STUCK: "stuck at one reading",
    Fault.GAIN: "with forces that would throw the body; check unit and gain",
    Fault.SIGN: "pulling where they should push; check the sign",
}


def cleaned(
    plates: Sequence[PlateReadings], mass_kg: float
) -> tuple[tuple[PlateReadings, ...], tuple[str, ...]]:
    """Plates without impossible readings, and one remark for each plate that had some.

    Args:
        plates: The plates of a trial.
        mass_kg: The person's mass.

    Returns:
        The plates, those without a fault as they were given; and the remarks.
    """
    found = [
        _cleaned(plate, float(reach), mass_kg) for plate, reach in zip(plates, reaches(plates), strict=True)
    ]
    return tuple(plate for plate, _ in found), tuple(remark for _, remark in found if remark)


def longest_bridge(rate_hz: float) -> int:
    """Number of samples in the longest gap that is bridged."""
    return round(BRIDGED_S * rate_hz)


def bridgeable(bad: BoolArray, rate_hz: float) -> BoolArray:
    """(S,) bad samples (S,) in a short gap with a good sample on either side."""
    short = np.zeros(len(bad), dtype=bool)
    for first, after in runs(bad):
        inside = first > 0 and after < len(bad)
        short[first:after] = inside and after - first <= longest_bridge(rate_hz)
    return short


def _cleaned(plate: PlateReadings, reach_m: float, mass_kg: float) -> tuple[PlateReadings, str]:
    weight_n = GRAVITY_M_S2 * mass_kg
    given = np.hstack([plate.force_n, plate.moment_nm])
    wrench, faults = given, np.full(len(given), NO_FAULT)
    for _ in range(MOST_PASSES):
        found = faults_of(wrench, plate.rate_hz, weight_n, reach_m)
        fresh = (found != NO_FAULT) & (faults == NO_FAULT)
        if not fresh.any():
            break
        faults[fresh] = found[fresh]
        bad = faults != NO_FAULT
        lost = bad & ~bridgeable(bad, plate.rate_hz)
        wrench = np.where(lost[:, None], np.nan, bridged(given, bad))
    bad = faults != NO_FAULT
    if not bad.any():
        return plate, ""
    force, moment = wrench[:, :3], wrench[:, 3:]
    normal = np.array([0.0, 0.0, 1.0]) if plate.corners_m is None else plate_normal(plate.corners_m)
    pressed = plate.centre_of_pressure_m.copy()
    pressed[bad] = centre_of_pressure(force[bad], moment[bad], plate.origin_m, normal, plate.threshold_n)
    clean = replace(plate, force_n=force, moment_nm=moment, centre_of_pressure_m=pressed)
    return clean, _remark(plate, faults)


def _remark(plate: PlateReadings, faults: Faults) -> str:
    bad = faults != NO_FAULT
    parts = []
    for kind in np.unique(faults[bad]).tolist():
        stretches = [_when(plate, *run) for run in runs(faults == kind)]
        times = ", ".join(stretches[:NAMED_STRETCHES]) + (" …" if len(stretches) > NAMED_STRETCHES else "")
        parts.append(f"{int((faults == kind).sum())} {WORDS[Fault(kind)]} ({times})")
    short = int(bridgeable(bad, plate.rate_hz).sum())
    lost_s = (int(bad.sum()) - short) / plate.rate_hz
    ends = [f"{short} are bridged"] if short else []
    ends += [f"for {lost_s:.3g} s the plate is taken as not recorded"] if lost_s else []
    samples = f"{int(bad.sum())} of {len(bad)} samples"
    return (
        f"plate '{plate.name}': {samples} are impossible and refused: {'; '.join(parts)}; {', '.join(ends)}"
    )


def _when(plate: PlateReadings, first: int, after: int) -> str:
    """Time of a stretch of samples, in words."""
    begin_s, end_s = (plate.start_time_s + sample / plate.rate_hz for sample in (first, after - 1))
    return f"at {begin_s:.3f} s" if after - first == 1 else f"{begin_s:.3f} to {end_s:.3f} s"
