"""Mass by the plates of a capture before a body is scaled: plates have to agree with a person's weight.

Over stretches in which every low foot is on a plate, the impulse of the plates gives the mass
(:mod:`mbkf.trial.checks.mass`). The centre of mass rises and falls nearly as the markers of the upper half of the body
do. Where feet stand elsewhere, or are not seen, an upper bound remains: over a second, plates carry no more than the
weight of a body that neither rises nor falls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.findings import Finding, judgement
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.numerics.printed import percent
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import bridged, dilated
from mbkf.sensors.contact.plates import PlateAreas, plate_wrenches, surface_height
from mbkf.trial.checks.evidence import BRIDGE_S
from mbkf.trial.checks.mass import (
    BOUND_PERCENT,
    NAME,
    SCALE_PERCENT,
    VerticalLoads,
    impulse_finding,
    undetermined,
)
from mbkf.trial.checks.plate_contradictions import plate_contradictions

PLATES_KEY = "plates_against_mass"
"""Key of a subject's report that lists the captures whose plates, or whose own statement, contradict the mass."""

STATED_SHARE = 0.1
"""Largest difference of the mass from the one that a capture states, as a share of that."""

PERSONS_KG = (8.0, 250.0)
"""Masses that a person who is captured standing or walking may have."""

SPEED_SD_M_S, SPEED_SHARE = 0.1, 0.25
"""Standard deviation of the vertical speed of the centre of mass by markers of the upper half of the body: a constant
part, and a share of the RMS speed. Over half cycles of public runs the speed is off by 0.2 m/s."""

PART_S = 1.0
"""Duration of parts of a trial that have to agree on the mass."""

LOW_M, RAISED_M = 0.15, 0.06
"""Markers that come as near to the floor as the first belong to feet; those above their lowest by the second are off
the floor."""

SLOW_M_S = 1.0
"""A low marker that moves faster than this belongs to a swinging foot."""

BESIDE_M = 0.04
"""Distance by which a marker on a foot may stand beside the plate that the foot is on."""

UNDER_FOOT_M = 0.3
"""Distance from a centre of pressure within which markers belong to the foot that it is under."""

AROUND_S = 0.06
"""Duration around a foot beside the plates in which it may carry load unseen."""

LEAST_S = 1.0
"""Duration over which a mean force counts."""


def unscaled_mass_finding(capture: Capture, mass_kg: float | None = None) -> Finding:
    """The mass stated over that of the plates, % more; without a stated mass, whether that of the plates is a person's.

    Args:
        capture: The capture, in world axes (z up).
        mass_kg: The mass; by default the one that the capture states.

    Returns:
        The finding, whose ``better`` is the mass by the plates, where they carry the whole body for long enough.
    """
    stated_kg = capture.subject_mass_kg if mass_kg is None else mass_kg
    if not capture.plates or not capture.markers.frames:
        return undetermined("no plates")
    loads = _loads(capture, stated_kg or PERSONS_KG[1])
    found = impulse_finding(loads, np.zeros(len(loads.force_n), dtype=bool))
    if found.better is not None and found.expected_sd is not None:
        return _judged(found.better, found.expected_sd, stated_kg, "the plates carry")
    most_kg, sd = _mean_kg(loads)
    bound_kg = PERSONS_KG[1] if stated_kg is None else stated_kg
    if most_kg * (1.0 - 0.02 * sd) > (1.0 + 0.01 * BOUND_PERCENT) * bound_kg:
        return _judged(most_kg, sd, stated_kg, "the plates carry on average")
    return found


def plate_notes(captures: Sequence[Capture], mass_kg: float | None = None) -> list[str]:
    """A sentence on each contradiction of the captures' plates, with the mass, any person's, their areas or feet."""
    notes = []
    for one in captures:
        if not one.plates:
            continue
        finding = unscaled_mass_finding(one, mass_kg)
        of_mass = (finding.hint,) if finding.verdict == "outside" else ()
        where = f"{one.path}: " if len(captures) > 1 else ""
        notes += [f"{where}{note}" for note in (*of_mass, *plate_contradictions(one))]
    return notes


def stated_mass_notes(captures: Sequence[Capture], mass_kg: float) -> list[str]:
    """A sentence on each mass that captures state and that the person's contradicts.

    Args:
        captures: Captures of the person.
        mass_kg: The person's mass: given, stated by another capture, or weighed by plates.
    """
    stated = {one.subject_mass_kg: one.path for one in reversed(captures) if one.subject_mass_kg is not None}
    return [
        f"{path} states a body mass of {kg:.1f} kg, and the person is scaled with {mass_kg:.1f} kg "
        f"({percent(abs(mass_kg / kg - 1.0))} {'more' if mass_kg > kg else 'less'}); give the right one with --mass KG"
        for kg, path in stated.items()
        if abs(mass_kg / kg - 1.0) > STATED_SHARE
    ]


def _judged(mass_kg: float, sd: float, stated_kg: float | None, subject: str) -> Finding:
    """The verdict on a mass by the plates with its standard deviation, %."""
    causes = "check the plates' units, gains and offsets"
    if stated_kg is None:
        right = PERSONS_KG[0] <= mass_kg <= PERSONS_KG[1]
        hint = f"{subject} {mass_kg:.1f} kg"
        if not right:
            hint += f", which is not a person's weight ({mass_kg * GRAVITY_M_S2:.0f} N); {causes}"
        return Finding(NAME, None, None, "%", BOUND_PERCENT, "inside" if right else "outside", hint, mass_kg)
    off = 100.0 * (stated_kg / mass_kg - 1.0)
    verdict = judgement(off, sd, BOUND_PERCENT)
    hint = f"{subject} {mass_kg:.1f} kg, and the body mass is stated as {stated_kg:.1f} kg"
    if verdict == "outside":
        more = f"{percent(abs(mass_kg / stated_kg - 1.0))} {'more' if mass_kg > stated_kg else 'less'}"
        other = (
            "a load that the person carries or pulls"
            if mass_kg > stated_kg
            else "a support beside the plates"
        )
        hint = f"{hint} ({more}); check the mass, {other}, and {causes.removeprefix('check ')}"
    return Finding(NAME, off, sd, "%", BOUND_PERCENT, verdict, hint, mass_kg)


def _loads(capture: Capture, mass_kg: float) -> VerticalLoads:
    """Vertical force and speed by frames, and the frames in which every foot that may stand is on a plate."""
    markers, plates = capture.markers, capture.plates
    force = plate_wrenches(plates, markers.times_s, markers.rate_hz)[:, :, 2].sum(axis=1)
    speed = _speed(markers, min(surface_height(plate) for plate in plates))
    known = np.isfinite(force) & np.isfinite(speed)
    accounted = known & _on_plates(markers, plates)
    vigour = float(np.sqrt(np.mean(speed[known] ** 2))) if known.any() else 0.0
    speed_sd = float(np.hypot(SPEED_SD_M_S, SPEED_SHARE * vigour))
    return VerticalLoads(markers.rate_hz, mass_kg, force, speed, accounted, speed_sd, PART_S)


def _mean_kg(loads: VerticalLoads) -> tuple[float, float]:
    """Mean mass by the longest stretch in which plates were recorded, and its standard deviation, %; 0 without one."""
    runs = stretches(np.isfinite(loads.force_n))
    longest = max(runs, key=len, default=np.zeros(0, dtype=int))
    lasting_s = len(longest) / loads.rate_hz
    if lasting_s < LEAST_S:
        return 0.0, 0.0
    sd = 100.0 * np.sqrt(2.0) * loads.speed_sd_m_s / (GRAVITY_M_S2 * lasting_s)
    return float(loads.force_n[longest].mean()) / GRAVITY_M_S2, float(np.hypot(sd, SCALE_PERCENT))


def _speed(markers: MarkerTrajectories, floor_m: float) -> Array:
    """(T,) vertical speed of the upper half of the body: the median of its markers' speeds, over 60 ms; NaN unseen."""
    heights = markers.positions_m[:, :, 2] - floor_m
    seen = np.asarray(np.isfinite(heights).any(axis=0))
    if not seen.any() or len(heights) < 3:
        return np.full(len(heights), np.nan)
    typical = np.full(len(seen), -np.inf)
    typical[seen] = np.nanmedian(heights[:, seen], axis=0)
    upper = heights[:, typical > 0.5 * typical.max()]
    speeds = np.gradient(upper, 1.0 / markers.rate_hz, axis=0)
    speed = np.full(len(heights), np.nan)
    some = np.isfinite(speeds).any(axis=1)
    speed[some] = np.nanmedian(speeds[some], axis=1)
    width = max(1, round(AROUND_S * markers.rate_hz))
    found = np.full(len(heights), np.nan)
    for run in stretches(np.isfinite(speed)):
        padded = np.pad(speed[run], (width // 2, width - 1 - width // 2), mode="edge")
        found[run] = np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
    return found


def _on_plates(markers: MarkerTrajectories, plates: Sequence[PlateReadings]) -> BoolArray:
    """(T,) frames in which all markers on feet are seen, and each is on a plate, raised, or swings."""
    floor_m = min(surface_height(plate) for plate in plates)
    heights = markers.positions_m[:, :, 2] - floor_m
    seen = np.asarray(np.isfinite(heights).any(axis=0))
    lowest = np.full(len(seen), np.inf)
    lowest[seen] = np.nanpercentile(heights[:, seen], 5.0, axis=0)
    feet = np.flatnonzero(lowest < LOW_M)
    if len(feet) < 2 or markers.frames < 2:
        return np.zeros(markers.frames, dtype=bool)
    places = markers.positions_m[:, feet]
    speeds = np.linalg.norm(np.gradient(places, 1.0 / markers.rate_hz, axis=0), axis=2)
    stands = (heights[:, feet] < lowest[feet] + RAISED_M) & ~(speeds > SLOW_M_S)
    beside = (stands & ~_over(places, markers, plates)) | ~np.isfinite(heights[:, feet])
    on_plates = bridged(~beside.any(axis=1), round(0.5 * BRIDGE_S * markers.rate_hz))
    return ~dilated(~on_plates, round(AROUND_S * markers.rate_hz))


def _over(places: Array, markers: MarkerTrajectories, plates: Sequence[PlateReadings]) -> BoolArray:
    """(T, K) places (T, K, 3) over the area of a plate, or near a centre of pressure where its area is not known."""
    wide = tuple(replace(plate, corners_m=_widened(plate.corners_m)) for plate in plates)
    inside = PlateAreas(wide).contain(np.nan_to_num(places[:, :, :2]).reshape(-1, 2))
    over = inside.reshape(*places.shape[:2], -1).any(axis=2)
    for plate in plates:
        if plate.corners_m is None and len(plate.force_n):
            sample = np.rint((markers.times_s - plate.start_time_s) * plate.rate_hz).astype(int)
            at = plate.centre_of_pressure_m[np.clip(sample, 0, len(plate.force_n) - 1)]
            away = np.linalg.norm(places[:, :, :2] - at[:, None, :2], axis=2)
            over |= away < UNDER_FOOT_M
    return np.asarray(over)


def _widened(corners_m: Array | None) -> Array | None:
    """Corners (4, 3) moved outwards, along both sides."""
    if corners_m is None:
        return None
    out = corners_m - corners_m.mean(axis=0)
    return np.asarray(corners_m + np.sqrt(2.0) * BESIDE_M * out / np.linalg.norm(out, axis=1)[:, None])
