"""Force plates of a C3D file: from analog channels to force and moment about the centre of the surface.

A plate's own axes follow from its corners, which lie in its quadrants (+x+y), (−x+y), (−x−y), (+x−y); its z
points down, and the channels hold the force of the plate on the body, so that a standing person reads −Fz.
ORIGIN is the vector from the point the channels refer to, O, to the centre of the surface, S, in plate axes
(its z is negative; often stored with the opposite sign). Moments move by M_S = M_O + F × ORIGIN. Layouts:

- type 1: Fx Fy Fz, centre of pressure x y, free moment Tz;
- type 2: Fx Fy Fz Mx My Mz;
- type 3: Fx12 Fx34 Fy14 Fy23 Fz1 Fz2 Fz3 Fz4 of four sensors at (±a, ±b), with ORIGIN = (a, b, z);
- type 4: like type 2 after multiplication with CAL_MATRIX (its first index is the row).

Source: The C3D File Format, section FORCE_PLATFORM (c3d.org).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import METRES_PER_UNIT

CHANNELS_OF_TYPE = {1: 6, 2: 6, 3: 8, 4: 6}
"""Number of analog channels of each plate type that can be read."""

_FORCE_UNITS = {"n": 1.0, "newton": 1.0, "newtons": 1.0, "kn": 1000.0, "lbf": 4.4482216152605}
_LEAST_SIDE_M = 0.02


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
        calibration: (6, 6) CAL_MATRIX, or None.
    """

    number: int
    kind: int
    corners: Array
    origin: Array
    readings: Array
    units: tuple[str, ...]
    rate_hz: float
    calibration: Array | None = None


def plate_axes(corners: Array) -> Array:
    """Axes of a plate from its corners.

    Args:
        corners: (3, 4) corners in their order, any unit.

    Returns:
        (3, 3) rotation whose columns are the plate's x, y and (downward) z in the axes of the corners.
    """
    x = corners[:, 0] + corners[:, 3] - corners[:, 1] - corners[:, 2]
    y = corners[:, 0] + corners[:, 1] - corners[:, 2] - corners[:, 3]
    x = x / np.linalg.norm(x)
    z = np.cross(x, y)
    z = z / np.linalg.norm(z)
    return np.column_stack([x, np.cross(z, x), z])


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
            path, f"{name} is of type {plate.kind}; only 1 to 4 can be read; give its forces with --forces"
        )
    needed = CHANNELS_OF_TYPE[plate.kind]
    if plate.readings.shape[1] != needed:
        found = plate.readings.shape[1]
        raise FileFormatError(path, f"{name} of type {plate.kind} needs {needed} channels, it has {found}")
    sides = np.diff(plate.corners[:, [0, 1, 2, 3, 0]], axis=1) * METRES_PER_UNIT[unit]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1])) if np.isfinite(sides).all() else 0.0
    if area < _LEAST_SIDE_M**2:
        raise FileFormatError(
            path, f"{name} has no usable CORNERS, so it is not calibrated; calibrate it or use --forces"
        )
    if plate.kind == 4 and (plate.calibration is None or not np.any(plate.calibration)):
        raise FileFormatError(path, f"{name} is of type 4 without CAL_MATRIX; calibrate it or use --forces")
    if plate.kind == 3 and not np.all(plate.origin[:2]):
        raise FileFormatError(path, f"{name} is of type 3 but ORIGIN lacks the places of its sensors")


def wrench_at_surface(plate: RawPlate, unit: str) -> Array:
    """Force and moment of a plate on the body, about the centre of its surface.

    Args:
        plate: The plate, checked.
        unit: The file's length unit, in which moments are N times that unit unless they state their own.

    Returns:
        (S, 6) force in N and moment in N m in the file's axes (not the plate's).
    """
    metre = METRES_PER_UNIT[unit]
    a, b, depth = np.abs(plate.origin) * metre
    origin = plate.origin * metre
    if origin[2] > 0.0:
        origin = -origin
    values = plate.readings
    if plate.kind == 1:
        force = values[:, :3] * _forces(plate.units[:3])
        lever = np.zeros_like(force)
        lever[:, :2] = values[:, 3:5] * _lengths(plate.units[3:5], metre) - origin[:2]
        moment = np.cross(lever, force)
        moment[:, 2] += values[:, 5] * _moments(plate.units[5:], metre)[0]
    elif plate.kind == 3:
        fx12, fx34, fy14, fy23, *fz = (values * _forces(plate.units)).T
        force = np.column_stack([fx12 + fx34, fy14 + fy23, sum(fz)])
        moment = np.column_stack(
            [
                b * (fz[0] + fz[1] - fz[2] - fz[3]),
                a * (-fz[0] + fz[1] + fz[2] - fz[3]),
                b * (fx34 - fx12) + a * (fy14 - fy23),
            ]
        )
        moment += np.cross(force, [0.0, 0.0, -depth])
    else:
        if plate.kind == 4:
            assert plate.calibration is not None  # check_geometry has seen to it
            values = values @ plate.calibration.T
            force, moment = values[:, :3], values[:, 3:] * metre
        else:
            force = values[:, :3] * _forces(plate.units[:3])
            moment = values[:, 3:] * _moments(plate.units[3:], metre)
        moment = moment + np.cross(force, origin)
    axes = plate_axes(plate.corners)
    return np.hstack([force @ axes.T, moment @ axes.T])


def _forces(units: tuple[str, ...]) -> Array:
    """Newtons per unit of force; units that are none (empty, V) are taken as N, by the format's rule."""
    return np.array([_FORCE_UNITS.get(unit.strip().lower(), 1.0) for unit in units])


def _lengths(units: tuple[str, ...], metre: float) -> Array:
    """Metres per unit of length; empty units are the file's own."""
    return np.array([METRES_PER_UNIT.get(unit.strip().lower(), metre) for unit in units])


def _moments(units: tuple[str, ...], metre: float) -> Array:
    """N m per unit of moment ("Nmm", "N.m", "N*mm" …); units that are none are N times the file's length."""
    factors = []
    for unit in units:
        word = "".join(letter for letter in unit.lower() if letter.isalpha()).removeprefix("newton")
        force = 1000.0 if word.startswith("kn") else 1.0
        length = word.removeprefix("k").removeprefix("n")
        factors.append(force * METRES_PER_UNIT.get(length, metre))
    return np.array(factors)
