"""Force plates under every placement of a foot, and their readings: the truth with noise and offset."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.io.records import CaptureEvent, PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N, centre_of_pressure

SIZE_M = (0.50, 0.40)
GAP_M = 0.005
MOST_PLATES = 40
"""A C3D file counts analog channels, six a plate, in one byte; further steps fall on plain floor."""

SAME_PLACE_M = 0.25
"""Spells of one foot whose mean pressure lies closer than this share a plate."""


@dataclass(frozen=True)
class Placement:
    """One foot on one spot: side 0 right, 1 left; the (start, end) samples of its spells; its (2,) middle, m."""

    side: int
    spells: tuple[tuple[int, int], ...]
    middle: Array


def placements(wrench: Array) -> list[Placement]:
    """Where feet stand, from (S, 2, 6) true foot wrenches about the world origin; in order of time."""
    found: list[Placement] = []
    for side in range(len(SIDES)):
        own: list[Placement] = []
        for start, end in spells(wrench[:, side, 2] > 0):
            force, moment = wrench[start:end, side, :3], wrench[start:end, side, 3:]
            pressure = np.column_stack([-moment[:, 1], moment[:, 0]]) / force[:, 2:]
            middle = 0.5 * (pressure.min(axis=0) + pressure.max(axis=0))
            same = [k for k, p in enumerate(own) if np.linalg.norm(p.middle - middle) < SAME_PLACE_M]
            if same:
                k = same[0]
                own[k] = Placement(side, (*own[k].spells, (start, end)), 0.5 * (own[k].middle + middle))
            else:
                own.append(Placement(side, ((start, end),), middle))
        found += own
    return sorted(found, key=lambda p: p.spells[0])


def spells(on: np.ndarray) -> list[tuple[int, int]]:
    """(start, end) of the runs of True in a (S,) condition."""
    edges = np.flatnonzero(np.diff(np.r_[False, on, False].astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def outlines(placed: list[Placement]) -> list[Array]:
    """(4, 3) corners of one plate per placement, not overlapping: from above, x and −y to the quadrants."""
    corners = []
    for p in placed:
        low, high = p.middle - np.array(SIZE_M) / 2, p.middle + np.array(SIZE_M) / 2
        for other in placed:
            if other.side != p.side and abs(other.middle[0] - p.middle[0]) < SIZE_M[0]:
                between = 0.5 * (other.middle[1] + p.middle[1])
                if p.middle[1] > between:
                    low[1], high[1] = between + GAP_M / 2, between + GAP_M / 2 + SIZE_M[1]
                else:
                    low[1], high[1] = between - GAP_M / 2 - SIZE_M[1], between - GAP_M / 2
        corners.append(
            np.array([[high[0], low[1], 0], [low[0], low[1], 0], [low[0], high[1], 0], [high[0], high[1], 0]])
        )
    return corners


def readings(
    wrench: Array,
    rate_hz: float,
    force_sd_n: float,
    moment_sd_nm: float,
    offset_n: tuple[float, float],
    rng: np.random.Generator,
) -> tuple[PlateReadings, ...]:
    """Readings that the first :data:`MOST_PLATES` plates store, offset included.

    Plates on which someone stands all the time were zeroed before and have no offset.

    Args:
        wrench: (S, 2, 6) true foot wrenches about the world origin.
        rate_hz: Their sample rate.
        force_sd_n: White noise per force channel.
        moment_sd_nm: White noise per moment channel.
        offset_n: Range of the vertical offset.
        rng: Source of noise and offsets.
    """
    placed = placements(wrench)[:MOST_PLATES]
    found = []
    for number, (place, corners) in enumerate(zip(placed, outlines(placed), strict=True), start=1):
        origin = corners.mean(axis=0)
        loaded = np.zeros(len(wrench), dtype=bool)
        for start, end in place.spells:
            loaded[start:end] = True
        force = np.where(loaded[:, None], wrench[:, place.side, :3], 0.0)
        moment = np.where(loaded[:, None], wrench[:, place.side, 3:], 0.0) - np.cross(origin, force)
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
        for start, end in spells(wrench[:, side, 2] > 0):
            if start > 0:
                events.append(CaptureEvent("Foot Strike", context, start / rate_hz))
            if end < len(wrench):
                events.append(CaptureEvent("Foot Off", context, end / rate_hz))
    return tuple(sorted(events, key=lambda event: event.time_s))
