"""Force plates of a C3D file: from analog channels to force and moment about the centre of the surface.

A plate's own axes follow from its corners (:mod:`mbkf.io.plate_corners`); its z points down, and the channels hold the
force of the plate on the body, so that a standing person reads −Fz.
ORIGIN is the vector from the point the channels refer to, O, to the centre of the surface, S, in plate axes
(its z is negative; for other signs see :mod:`mbkf.io.c3d_origin`). Moments move by M_S = M_O + F × ORIGIN. Layouts:

- type 1: Fx Fy Fz, centre of pressure x y, free moment Tz;
- type 2: Fx Fy Fz Mx My Mz;
- type 3: Fx12 Fx34 Fy14 Fy23 Fz1 Fz2 Fz3 Fz4 of four sensors at (±a, ±b), with ORIGIN = (a, b, z);
- type 4: like type 2 after multiplication with CAL_MATRIX (6 × 6; its first index is the row);
- type 5: eight channels that CAL_MATRIX (6 × 8) turns into those of type 2;
- type 6: Fx1 Fy1 Fz1 … Fx4 Fy4 Fz4 of four sensors as in type 3, after multiplication with CAL_MATRIX (12 × 12);
- type 7: like type 3 after multiplication with CAL_MATRIX (8 × 8).

Sources: The C3D File Format, section FORCE_PLATFORM (c3d.org); for types 5 to 7 Visual3D's documentation of FP_TYPE.
Types 11, 12 and 21 are stairs and treadmills of single makers, of which no description was found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import METRES_PER_UNIT
from mbkf.io.c3d_origin import (
    LEAST_LOADED,
    LOADED_N,
    MOSTLY,
    SELDOM,
    pressed_m,
    share_on_plate,
    turned_by_depth,
    turned_by_pressure,
)
from mbkf.io.plate_corners import has_area, plate_axes, plate_sides
from mbkf.io.wrench import PlateWay

CHANNELS_OF_TYPE = {1: 6, 2: 6, 3: 8, 4: 6, 5: 8, 6: 12, 7: 8}
"""Number of analog channels of each plate type that can be read."""

CALIBRATION_OF_TYPE = {4: (6, 6), 5: (6, 8), 6: (12, 12), 7: (8, 8)}
"""Rows and columns of CAL_MATRIX of the types that have one."""

SENSORS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""Places of the four sensors of types 3, 6 and 7, over ORIGIN's (a, b)."""

_FORCE_UNITS = {"n": 1.0, "newton": 1.0, "newtons": 1.0, "kn": 1000.0, "lbf": 4.4482216152605}

STILL_M, FAR_M = 0.001, 10.0
"""A person's pressure moves by more than the first, and stays nearer to a plate's middle than the second."""


@dataclass(frozen=True)
class RawPlate:
    """One plate as a C3D file describes it.

    Attributes:
        number: Its number in the file, counted from 1.
        kind: Type, see the module.
        corners: (3, 4) corners in the file's axes and length unit.
        origin: (3,) ORIGIN in the file's length unit.
        readings: (S, C) its channels, scaled by the parameters of ANALOG.
        units: C units of the channels.
        rate_hz: Their sample rate in Hz.
        calibration: CAL_MATRIX with the shape of its type, or None.
    """

    number: int
    kind: int
    corners: Array
    origin: Array
    readings: Array
    units: tuple[str, ...]
    rate_hz: float
    calibration: Array | None = None


def check_geometry(plate: RawPlate, path: str, unit: str) -> None:
    """Refuse plates whose position or calibration the file does not hold.

    Args:
        plate: The plate.
        path: The file, for the message.
        unit: Length unit of its corners.

    Raises:
        FileFormatError: Unknown type, wrong number of channels, missing or flat corners, no CAL_MATRIX.
    """
    name = f"force plate {plate.number}"
    if plate.kind not in CHANNELS_OF_TYPE:
        raise FileFormatError(
            path, f"{name} is of type {plate.kind}; only 1 to 7 can be read; give its forces with --forces"
        )
    needed = CHANNELS_OF_TYPE[plate.kind]
    if plate.readings.shape[1] != needed:
        found = plate.readings.shape[1]
        raise FileFormatError(path, f"{name} needs {needed} channels, it has {found} (type {plate.kind})")
    with np.errstate(over="ignore"):
        usable = has_area(plate.corners.T * METRES_PER_UNIT[unit])
    if not usable:
        raise FileFormatError(
            path, f"{name} has no usable CORNERS, so it is not calibrated; calibrate it or use --forces"
        )
    if plate.kind in CALIBRATION_OF_TYPE and (plate.calibration is None or not np.any(plate.calibration)):
        reason = f"{name} is of type {plate.kind} without CAL_MATRIX; calibrate it or use --forces"
        raise FileFormatError(path, reason)
    if plate.kind in {3, 6, 7} and not np.all(plate.origin[:2]):
        raise FileFormatError(
            path, f"{name} is of type {plate.kind} but ORIGIN lacks the places of its sensors"
        )


class SurfaceWrench(NamedTuple):
    """Readings about the middle of a plate's surface, in the file's axes, and the way to them.

    Attributes:
        wrench: (S, 6) force in N and moment in N m on the body.
        origin_m: (3,) ORIGIN with the signs that were used.
        factor: Factor of the moments.
    """

    wrench: Array
    origin_m: Array
    factor: float


def wrench_at_surface(
    plate: RawPlate, unit: str, notes: list[str], known: PlateWay | None = None
) -> SurfaceWrench:
    """Force and moment of a plate on the body, about the centre of its surface.

    Args:
        plate: The plate, checked.
        unit: The file's length unit, in which moments are N times that unit unless they state their own.
        notes: Receives remarks on moments in another unit, which is known by where they would press, and on an ORIGIN
            of another sign.
        known: Signs of ORIGIN and factor of the moments, where they are known; None: the readings show them.
    """
    metre, name, factor = METRES_PER_UNIT[unit], f"force plate {plate.number}", 1.0
    origin = turned_by_depth(plate.origin * metre, name, notes) if known is None else known.origin_m
    values, units = plate.readings, plate.units
    if plate.kind in CALIBRATION_OF_TYPE:
        assert plate.calibration is not None  # check_geometry has seen to it
        values, units = values @ plate.calibration.T, ("",) * len(plate.calibration)
    if plate.kind == 1:
        force = values[:, :3] * _forces(units[:3])
        lever = np.zeros_like(force)
        lever[:, :2] = values[:, 3:5] * _lengths(units[3:5], metre) - origin[:2]
        moment = np.cross(lever, force)
        moment[:, 2] += values[:, 5] * _moments(units[5:], metre)[0]
    elif plate.kind in {3, 6, 7}:
        values = values * _forces(units)
        joined = values if plate.kind == 6 else _of_each_sensor(values)
        force, moment = _of_sensors(joined.reshape(-1, 4, 3), np.abs(plate.origin) * metre)
    else:
        force = values[:, :3] * _forces(units[:3])
        moment = values[:, 3:] * _moments(units[3:], metre)
        half_sides_m = 0.25 * metre * np.linalg.norm(plate_sides(plate.corners.T), axis=1)
        if known is None:
            origin = turned_by_pressure(origin, force, moment, half_sides_m, name, notes)
        shift = np.cross(force, origin)
        factor = _unit_factor(force, moment, shift, half_sides_m) if known is None else known.factor
        if factor != 1.0:
            notes.append(
                f"{name}: moments are taken {factor:g} times as large as their unit says, since the centre of "
                "pressure is then on the plate"
            )
        moment = factor * moment + shift
    axes = plate_axes(plate.corners.T)
    return SurfaceWrench(np.hstack([force @ axes.T, moment @ axes.T]), origin, factor)


def _unit_factor(force: Array, moment: Array, shift: Array, half_sides_m: Array) -> float:
    """1000 or 1/1000 where moments are evidently in N m instead of N mm, or the reverse; else 1.

    Moments that are too small press within a millimetre of one point, closer than any foot stands still; those that are
    too large press beside the plate. Forces (S, 3) N, moments (S, 3) N m about the transducers and
    their shift (S, 3) to the surface are in plate axes.
    """
    loaded = np.abs(force[:, 2]) > LOADED_N
    if np.count_nonzero(loaded) < LEAST_LOADED:
        return 1.0

    def on_plate(factor: float) -> float:
        return share_on_plate(force, factor * moment + shift, half_sides_m)

    force, moment, shift = force[loaded], moment[loaded], shift[loaded]
    reach_m = float(np.percentile(np.linalg.norm(pressed_m(force, moment), axis=1), 95.0))
    if reach_m < STILL_M and on_plate(1e3) > MOSTLY:
        return 1e3
    return 1e-3 if reach_m > FAR_M and on_plate(1.0) < SELDOM and on_plate(1e-3) > MOSTLY else 1.0


def _of_each_sensor(values: Array) -> Array:
    """(S, 12) forces of four sensors from channels of type 3 (S, 8), whose pairs share shear in equal parts."""
    fx12, fx34, fy14, fy23, *fz = values.T
    fx, fy = (fx12, fx12, fx34, fx34), (fy14, fy23, fy23, fy14)
    return np.column_stack([half for k in range(4) for half in (0.5 * fx[k], 0.5 * fy[k], fz[k])])


def _of_sensors(forces: Array, places_m: Array) -> tuple[Array, Array]:
    """(S, 3) force and (S, 3) moment about the middle of the surface of four sensors' forces (S, 4, 3), N.

    ``places_m``: half the sensors' distances along x and y, and their depth below the surface.
    """
    lever = np.column_stack([SENSORS * places_m[:2], np.full(4, places_m[2])])  # z points down
    return forces.sum(axis=1), np.cross(lever, forces).sum(axis=1)


def _forces(units: tuple[str, ...]) -> Array:
    """Newtons per unit of force; an empty or unknown unit (V) counts as N, by the format's rule."""
    return np.array([_FORCE_UNITS.get(unit.strip().lower(), 1.0) for unit in units])


def _lengths(units: tuple[str, ...], metre: float) -> Array:
    """Metres per unit of length; empty units are the file's own."""
    return np.array([METRES_PER_UNIT.get(unit.strip().lower(), metre) for unit in units])


def _moments(units: tuple[str, ...], metre: float) -> Array:
    """N m per unit of moment ("Nmm", "N.m", "N*mm" …); an empty or unknown unit is N times the file's length."""
    factors = []
    for unit in units:
        word = "".join(letter for letter in unit.lower() if letter.isalpha()).removeprefix("newton")
        force = 1000.0 if word.startswith("kn") else 1.0
        length = word.removeprefix("k").removeprefix("n")
        factors.append(force * METRES_PER_UNIT.get(length, metre))
    return np.array(factors)
