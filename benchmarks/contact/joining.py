"""Captures as they would have been on other instruments: all plates as one, the ground as a belt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.wrench import centre_of_pressure

MARGIN_M = 0.3
"""How far a plate of unknown outline reaches beyond its pressures."""

_UP = np.array([0.0, 0.0, 1.0])


def joined(capture: Capture) -> Capture:
    """The same capture over one plate that reads the sum of all its plates, and is as large as they are together.

    Args:
        capture: A capture whose plates were recorded together.

    Raises:
        InvalidInput: It has no plates, or they were not recorded together.
    """
    plates = capture.plates
    if not plates or len({(plate.rate_hz, plate.start_time_s, len(plate.force_n)) for plate in plates}) != 1:
        raise InvalidInput("only plates that were recorded together can be joined")
    low, high, surface = _extent(plates)
    origin = np.array([*0.5 * (low + high), surface])
    force = np.sum([plate.force_n for plate in plates], axis=0)
    moment = np.sum([_about(plate, origin) for plate in plates], axis=0)
    corners = np.array([[x, y, surface] for x, y in _round(low, high)])
    return replace(capture, plates=(_plate(plates[0], origin, force, moment, corners),))


def on_belt(capture: Capture, speed_m_s: float) -> Capture:
    """A capture on one plate as a treadmill would have seen it: the ground moves back at a constant speed.

    A frame of reference that moves uniformly changes no force; positions and centres of pressure move back by speed
    times time. The plate then is the treadmill's, as large as needed.

    Args:
        capture: A walk along x over one plate.
        speed_m_s: Speed of the belt.

    Raises:
        InvalidInput: It has not one plate.
    """
    if len(capture.plates) != 1:
        raise InvalidInput("a belt is one plate")
    markers, plate = capture.markers, capture.plates[0]
    back = np.outer(markers.times_s, [-speed_m_s, 0.0, 0.0])
    moved = replace(markers, positions_m=markers.positions_m + back[:, None])
    moment = plate.moment_nm + np.cross(np.outer(plate.times_s, [-speed_m_s, 0.0, 0.0]), plate.force_n)
    seen = moved.positions_m[..., :2].reshape(-1, 2)
    corners = np.array([[x, y, plate.origin_m[2]] for x, y in _round(np.nanmin(seen, 0), np.nanmax(seen, 0))])
    return replace(
        capture, markers=moved, plates=(_plate(plate, plate.origin_m, plate.force_n, moment, corners),)
    )


def _extent(plates: tuple[PlateReadings, ...]) -> tuple[Array, Array, float]:
    """Least and greatest x and y of all plates, and the mean height of their surfaces."""
    if all(plate.corners_m is not None for plate in plates):
        corners = np.concatenate([plate.corners_m for plate in plates if plate.corners_m is not None])
        return corners[:, :2].min(axis=0), corners[:, :2].max(axis=0), float(corners[:, 2].mean())
    pressed = np.concatenate([plate.centre_of_pressure_m for plate in plates])[:, :2]
    surface = float(np.mean([plate.origin_m[2] for plate in plates]))
    return np.nanmin(pressed, axis=0) - MARGIN_M, np.nanmax(pressed, axis=0) + MARGIN_M, surface


def _round(low: Array, high: Array) -> list[tuple[float, float]]:
    """Corners of a rectangle from above, x and −y to the quadrants."""
    return [(high[0], low[1]), (high[0], high[1]), (low[0], high[1]), (low[0], low[1])]


def _about(plate: PlateReadings, origin_m: Array) -> Array:
    """(S, 3) a plate's moment about another origin."""
    return plate.moment_nm + np.cross(plate.origin_m - origin_m, plate.force_n)


def _plate(
    like: PlateReadings, origin_m: Array, force_n: Array, moment_nm: Array, corners_m: Array
) -> PlateReadings:
    """A plate recorded when another was, with readings of its own.

    Args:
        like: The other plate.
        origin_m: (3,) where its moments are taken.
        force_n: (S, 3) force.
        moment_nm: (S, 3) moment.
        corners_m: (4, 3) outline.
    """
    pressed = centre_of_pressure(force_n, moment_nm, origin_m, _UP, like.threshold_n)
    return PlateReadings(
        "1",
        like.rate_hz,
        like.start_time_s,
        origin_m,
        force_n,
        moment_nm,
        pressed,
        like.threshold_n,
        corners_m,
    )
