"""Force plates under every placement of a foot or under belts, and their readings: the truth with noise and offset."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.io.records import CaptureEvent, PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N, centre_of_pressure
from mbkf.numerics.runs import runs

SIZE_M = (0.50, 0.40)
GAP_M = 0.005
BELT_M, BELT_EDGE_M = (1.8, 0.5), 0.1
"""Usual size of a belt for one foot, and how far at least it reaches beyond the pressures."""

MOST_PLATES = 40
"""A C3D file counts analog channels, six a plate, in one byte; further steps fall on plain floor."""

SAME_PLACE_M = 0.25
"""Spells of one foot whose mean pressure lies closer than this share a plate."""


@dataclass(frozen=True)
class Placement:
    """One foot on one spot.

    Attributes:
        side: 0 right, 1 left.
        spells: (start, end) samples of the times it stands there.
        middle: (2,) middle of the pressure's path, m; of several spells, the mean of theirs.
        low, high: (2,) least and greatest coordinates of the centre of pressure, m.
        surface_m: Height of the surface.
    """

    side: int
    spells: tuple[tuple[int, int], ...]
    middle: Array
    low: Array
    high: Array
    surface_m: float = 0.0

    def joined(self, later: Placement) -> Placement:
        """This placement and a later spell on the same spot."""
        return Placement(
            self.side,
            (*self.spells, *later.spells),
            0.5 * (self.middle + later.middle),
            np.minimum(self.low, later.low),
            np.maximum(self.high, later.high),
            self.surface_m,
        )


def placements(wrench: Array, surface_m: Array) -> list[Placement]:
    """Where feet stand, in order of time.

    Args:
        wrench: (S, 2, 6) true foot wrenches about the world origin.
        surface_m: (S, 2) heights of the surfaces under the feet.
    """
    found: list[Placement] = []
    for side in range(len(SIDES)):
        own: list[Placement] = []
        for start, end in runs(wrench[:, side, 2] > 0):
            force, moment = wrench[start:end, side, :3], wrench[start:end, side, 3:]
            height = surface_m[start:end, side, None]
            lever = np.column_stack([-moment[:, 1], moment[:, 0]]) + height * force[:, :2]
            pressure = lever / force[:, 2:]
            low, high = pressure.min(axis=0), pressure.max(axis=0)
            new = Placement(side, ((start, end),), 0.5 * (low + high), low, high, float(height[0, 0]))
            same = [k for k, p in enumerate(own) if _same_spot(p, new)]
            if same:
                own[same[0]] = own[same[0]].joined(new)
            else:
                own.append(new)
        found += own
    return sorted(found, key=lambda p: p.spells[0])


def _same_spot(a: Placement, b: Placement) -> bool:
    return bool(a.surface_m == b.surface_m and np.linalg.norm(a.middle - b.middle) < SAME_PLACE_M)


def outlines(placed: list[Placement]) -> list[Array]:
    """(4, 3) corners of one plate per placement, not overlapping: from above, x and −y to the quadrants."""
    areas = [_area(p, placed) for p in placed]
    for k, (own, p) in enumerate(zip(areas, placed, strict=True)):
        for other, q in zip(areas[:k], placed[:k], strict=True):
            if (np.minimum(own[1], other[1]) > np.maximum(own[0], other[0])).all():
                _separate(own, p, other, q)
    return [
        np.array([[x, y, p.surface_m] for x, y in ((high[0], low[1]), low, (low[0], high[1]), high)])
        for (low, high), p in zip(areas, placed, strict=True)
    ]


def _area(p: Placement, placed: list[Placement]) -> Array:
    """(2, 2) least and greatest x and y of a plate of the usual size, beside those of the other foot."""
    size = np.array(SIZE_M)
    low, high = p.middle - size / 2, p.middle + size / 2
    for other in placed:
        if other.side == p.side or (np.abs(other.middle - p.middle) >= size).any():
            continue
        between = 0.5 * (other.middle[1] + p.middle[1])
        if p.low[1] > between > other.high[1]:
            low[1], high[1] = between + GAP_M / 2, between + GAP_M / 2 + size[1]
        elif p.high[1] < between < other.low[1]:
            low[1], high[1] = between - GAP_M / 2 - size[1], between - GAP_M / 2
    return np.array([np.minimum(low, p.low), np.maximum(high, p.high)])


def _separate(own: Array, p: Placement, other: Array, q: Placement) -> None:
    """Cuts two overlapping areas back to a line between their pressures' paths, where those are farthest apart."""
    after, before = p.low - q.high, q.low - p.high
    axis = int(np.argmax(np.maximum(after, before)))
    (first, a), (second, b) = ((other, q), (own, p)) if after[axis] > before[axis] else ((own, p), (other, q))
    between = 0.5 * (a.high[axis] + b.low[axis])
    first[1, axis] = min(first[1, axis], between - GAP_M / 2)
    second[0, axis] = max(second[0, axis], between + GAP_M / 2)


def on_spots(wrench: Array, surface_m: Array) -> list[tuple[Array, Array]]:
    """(S, 6) true wrench about the world origin and (4, 3) corners of the first :data:`MOST_PLATES` plates.

    Args:
        wrench: (S, 2, 6) true foot wrenches about the world origin.
        surface_m: (S, 2) heights of the surfaces under the feet.
    """
    placed = placements(wrench, surface_m)[:MOST_PLATES]
    found = []
    for place, corners in zip(placed, outlines(placed), strict=True):
        loaded = np.zeros(len(wrench), dtype=bool)
        for start, end in place.spells:
            loaded[start:end] = True
        found.append((np.where(loaded[:, None], wrench[:, place.side], 0.0), corners))
    return found


def on_belts(wrench: Array, surface_m: Array, belts: int) -> list[tuple[Array, Array]]:
    """(S, 6) true wrench about the world origin and (4, 3) corners of each belt's plate, from right to left.

    Args:
        wrench: (S, 2, 6) true foot wrenches about the world origin.
        surface_m: (S, 2) heights of the surfaces under the feet, all the same.
        belts: 1 for both feet, 2 for one each.
    """
    height = float(surface_m[0, 0])
    low, high = np.full((2, 2), np.inf), np.full((2, 2), -np.inf)
    for place in placements(wrench, surface_m):
        low[place.side] = np.minimum(low[place.side], place.low)
        high[place.side] = np.maximum(high[place.side], place.high)
    middle = np.array([0.5 * (low[:, 0].min() + high[:, 0].max()), 0.5 * (high[0, 1] + low[1, 1])])
    half = np.maximum(
        [0.5 * BELT_M[0], BELT_M[1]], [0.5 * np.ptp([low[:, 0], high[:, 0]]) + BELT_EDGE_M, 0.0]
    )
    (x0, y0), (x1, y1) = middle - half, middle + half
    edges = [(y0, y1)] if belts == 1 else [(y0, middle[1] - GAP_M / 2), (middle[1] + GAP_M / 2, y1)]
    wholes = [wrench.sum(axis=1)] if belts == 1 else [wrench[:, 0], wrench[:, 1]]
    return [
        (whole, np.array([[x, y, height] for x, y in ((x1, a), (x0, a), (x0, b), (x1, b))]))
        for whole, (a, b) in zip(wholes, edges, strict=True)
    ]


def readings(
    wrench: Array,
    surface_m: Array,
    rate_hz: float,
    force_sd_n: float,
    moment_sd_nm: float,
    offset_n: tuple[float, float],
    rng: np.random.Generator,
    belts: int = 0,
) -> tuple[PlateReadings, ...]:
    """Readings that the first :data:`MOST_PLATES` plates store, offset included.

    Plates on which someone stands all the time were zeroed before and have no offset.

    Args:
        wrench: (S, 2, 6) true foot wrenches about the world origin.
        surface_m: (S, 2) heights of the surfaces under the feet.
        rate_hz: Their sample rate.
        force_sd_n: White noise per force channel.
        moment_sd_nm: White noise per moment channel.
        offset_n: Range of the vertical offset.
        rng: Source of noise and offsets.
        belts: Belts that carry the plates: 1 under both feet, 2 for one each; 0 for a plate on every spot.
    """
    carried = on_belts(wrench, surface_m, belts) if belts else on_spots(wrench, surface_m)
    found = []
    for number, (whole, corners) in enumerate(carried, start=1):
        origin, loaded = corners.mean(axis=0), whole[:, 2] > 0
        force, moment = whole[:, :3], whole[:, 3:] - np.cross(origin, whole[:, :3])
        offset = np.r_[
            rng.uniform(-2, 2, 2), rng.uniform(min(offset_n), max(offset_n)), rng.uniform(-1, 1, 3)
        ]
        if loaded.all() or not any(offset_n):
            offset = np.zeros(6)
        force = force + offset[:3] + force_sd_n * rng.standard_normal(force.shape)
        moment = moment + offset[3:] + moment_sd_nm * rng.standard_normal(moment.shape)
        pressed = centre_of_pressure(
            force, moment, origin, np.array([0.0, 0.0, 1.0]), DEFAULT_COP_THRESHOLD_N
        )
        found.append(
            PlateReadings(
                str(number), rate_hz, 0.0, origin, force, moment, pressed, DEFAULT_COP_THRESHOLD_N, corners
            )
        )
    return tuple(found)


def contact_events(wrench: Array, rate_hz: float) -> tuple[CaptureEvent, ...]:
    """Foot strikes and foot offs inside the recording, in order of time."""
    events = []
    for side, context in enumerate(("Right", "Left")):
        for start, end in runs(wrench[:, side, 2] > 0):
            if start > 0:
                events.append(CaptureEvent("Foot Strike", context, start / rate_hz))
            if end < len(wrench):
                events.append(CaptureEvent("Foot Off", context, end / rate_hz))
    return tuple(sorted(events, key=lambda event: event.time_s))
