"""Force plates that contradict their own area or the feet on them, before anything is scaled: sign, unit and place.

A plate pushes up; the centre of its pressure lies on its area, moves, and has a foot above it. Corners in another unit
or in other axes, moments in N mm and forces in kN break one of these. Gains do not: they are for the mass to show
(:mod:`mbkf.trial.checks.unscaled_mass`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.numerics.printed import rounded

LOADED_N = 50.0
"""A plate is judged by samples with a vertical force of this size or more, up or down."""

LEAST_S = 0.1
"""Least duration of these samples."""

PULLED_N = 250.0
"""A load that was taken from a plate after zeroing is lighter than this."""

STANDING_S = 0.3
"""A foot that swings is above a plate, low and slow, for less time than this."""

SILENT_N = 10.0
"""Greatest vertical force of plates that carry no person."""

SIDES_M = (0.15, 6.0)
"""Lengths of the sides of plates and treadmills."""

BESIDE_AREA_M = 0.05
"""Median distance outside its area from which centres of pressure are wrong; right plates of the public captures of
`benchmarks/strangers/plates.py` have them 0.06 m and more inside."""

STAYS_M = 0.001
"""Centres of pressure lie farther from the middle of their plate than this, RMS of a coordinate: 22 mm and more on the
same plates."""

LOW_M = 0.25
"""Markers as near to the floor as this may belong to a foot."""

BESIDE_FEET_M = 0.35
"""Median distance from the nearest such marker from which no foot is above centres of pressure; at most 0.11 m on the
same plates."""

FEW = 200
"""Number of samples of a plate that are compared with the markers."""

SLOW_M_S = 0.3
"""Greatest speed of a marker on a foot that stands."""


def plate_contradictions(capture: Capture) -> tuple[str, ...]:
    """A sentence on each kind of contradiction, with the names of its plates.

    Args:
        capture: The capture, in world axes (z up).
    """
    kinds: dict[str, list[tuple[str, str]]] = {}
    for plate in capture.plates:
        found = _contradiction(plate, capture.markers)
        if found is not None:
            size, kind = found
            kinds.setdefault(kind, []).append((plate.name, size))
    return (*(_sentence(named, kind) for kind, named in kinds.items()), *_silent(capture))


def _sentence(named: Sequence[tuple[str, str]], kind: str) -> str:
    names = ", ".join(f"'{name}'" for name, _ in named)
    return f"force plate{'s' if len(named) > 1 else ''} {names}: {kind.format(named[0][1])}"


def _contradiction(plate: PlateReadings, markers: MarkerTrajectories) -> tuple[str, str] | None:
    """Size and kind of the first contradiction of a plate; the kind has a place for the size."""
    if plate.corners_m is not None:
        sides = _sides(plate.corners_m)
        if sides.min() < SIDES_M[0] or sides.max() > SIDES_M[1]:
            return f"{sides.max():.3g} × {sides.min():.3g}", "an area of {} m; check the unit of the corners"
    vertical = plate.force_n[:, 2]
    loaded = np.flatnonzero(np.abs(vertical) >= LOADED_N)
    if len(loaded) < LEAST_S * plate.rate_hz:
        return None
    down = vertical[loaded] < 0.0
    if down.mean() > 0.5:
        most_n = -float(vertical[loaded].min())
        if most_n < PULLED_N and _standing_s(plate, markers) < STANDING_S:
            return None  # a load that lay on the plate while it was zeroed
        return f"{most_n:.0f}", "forces of up to {} N pull feet down; check their sign"
    loaded = loaded[~down & np.isfinite(plate.centre_of_pressure_m[loaded]).all(axis=1)]
    return _misplaced(plate, loaded, markers) if len(loaded) >= LEAST_S * plate.rate_hz else None


def _misplaced(
    plate: PlateReadings, loaded: NDArray[np.intp], markers: MarkerTrajectories
) -> tuple[str, str] | None:
    """Size and kind of a contradiction of the centres of pressure in loaded samples, with the area or the feet."""
    pressure = plate.centre_of_pressure_m[loaded]
    if plate.corners_m is not None:
        away = float(np.median(_outside(pressure, plate.corners_m)))
        if away > BESIDE_AREA_M:
            return (
                f"{away:.2g}",
                "centres of pressure lie {} m outside the area; check corners, and the unit of the moments",
            )
        lever = float(np.sqrt(np.mean((pressure[:, :2] - plate.corners_m.mean(axis=0)[:2]) ** 2)))
        if lever < STAYS_M:
            return (
                rounded(1e3 * lever, 1),
                "centres of pressure stay within {} mm of the middle; check the unit of the moments",
            )
    beside = _beside_feet(plate, loaded, pressure, markers)
    if beside is None or beside <= BESIDE_FEET_M:
        return None
    return (
        f"{beside:.2f}",
        "centres of pressure lie {} m beside the feet; check the corners, their unit and axes",
    )


def _sides(corners_m: Array) -> Array:
    """(4,) lengths of the sides."""
    return np.asarray(np.linalg.norm(np.roll(corners_m, -1, axis=0) - corners_m, axis=1))


def _outside(points_m: Array, corners_m: Array) -> Array:
    """(n,) distance of points (n, 3) from a rectangular plate's area along its sides, m; negative over the area."""
    sides = corners_m[[1, 2]] - corners_m[[0, 1]]
    lengths = np.linalg.norm(sides, axis=1)
    along = np.abs((points_m - corners_m.mean(axis=0)) @ (sides / lengths[:, None]).T)
    return np.asarray((along - 0.5 * lengths).max(axis=1))


def _beside_feet(
    plate: PlateReadings, loaded: NDArray[np.intp], pressure: Array, markers: MarkerTrajectories
) -> float | None:
    """Median horizontal distance from centres of pressure to the nearest low marker; None where there is no such."""
    chosen = slice(None, None, max(1, len(loaded) // FEW))
    frames = np.rint((plate.times_s[loaded[chosen]] - markers.start_time_s) * markers.rate_hz).astype(int)
    there = (frames >= 0) & (frames < markers.frames)
    places = markers.positions_m[frames[there]]
    floor_m = float(pressure[:, 2].min())
    low = places[:, :, 2] < floor_m + LOW_M
    away = np.linalg.norm(places[:, :, :2] - pressure[chosen][there][:, None, :2], axis=2)
    nearest = np.where(low, away, np.inf).min(axis=1, initial=np.inf)
    seen = nearest[np.isfinite(nearest)]
    return float(np.median(seen)) if len(seen) >= min(10, len(nearest)) and len(seen) else None


def _silent(capture: Capture) -> Iterator[str]:
    """A sentence on plates that read next to nothing while a foot stands on one of them."""
    vertical = [plate.force_n[:, 2] for plate in capture.plates]
    read = np.abs(np.concatenate([one[np.isfinite(one)] for one in vertical] or [np.zeros(0)]))
    if not len(read) or read.max() >= SILENT_N:
        return
    seconds = max(_standing_s(plate, capture.markers) for plate in capture.plates)
    if seconds >= STANDING_S:
        cause = "the unit of their forces" if read.max() else "that they were on and recorded"
        yield (
            f"the force plates read at most {read.max():.2g} N, and a foot stands on one for {seconds:.1f} s; check "
            f"{cause}"
        )


def _standing_s(plate: PlateReadings, markers: MarkerTrajectories) -> float:
    """Time in which a marker is low and slow above a plate, the longest of all markers', s; 0 without corners."""
    if plate.corners_m is None or markers.frames < 2:
        return 0.0
    places = markers.positions_m
    speed = np.linalg.norm(np.gradient(places, 1.0 / markers.rate_hz, axis=0), axis=2)
    stands = (places[:, :, 2] < plate.corners_m[:, 2].mean() + LOW_M) & (speed < SLOW_M_S)
    above = _outside(np.nan_to_num(places).reshape(-1, 3), plate.corners_m).reshape(stands.shape) < 0.0
    return float((above & stands).sum(axis=0).max(initial=0)) / markers.rate_hz
