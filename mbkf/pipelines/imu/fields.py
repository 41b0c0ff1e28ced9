"""Magnetic fields compared between sensors: which magnetometer does not see what the others see.

The body's motion tells how each sensor is turned, without magnetometers. Turned into the world with it, all sensors of
a person see one field, but for iron nearby. One that sees it from elsewhere, or of another size, is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.imu.readings import ImuReadings

LEAST_SENSORS = 3
"""Fewer fields do not tell which of them is wrong."""

MOST_TURN_RAD = 0.45
"""A field further from the others' than this is another one; indoors fields differ by some 15°."""

SIZES = (0.6, 1.6)
"""Sizes of a field, as a share of the others', that indoor fields have."""


@dataclass(frozen=True)
class StrangeField:
    """A magnetometer that does not see what the others see.

    Attributes:
        sensor: Its name.
        turn_rad: Angle between its field and the others'.
        size: Its size as a share of theirs.
    """

    sensor: str
    turn_rad: float
    size: float

    @property
    def told(self) -> str:
        """What is the matter."""
        return (
            f"magnetometer of {self.sensor}: its field is turned by {np.degrees(self.turn_rad):.0f} deg against the "
            f"other sensors' and has {self.size:.2f} of its size; it is left out"
        )


def strange_fields(readings: Sequence[ImuReadings], rotations: Sequence[Array]) -> tuple[StrangeField, ...]:
    """Magnetometers that do not see the field of the others.

    Args:
        readings: Sensors; those without a magnetometer are left out.
        rotations: (T, 3, 3) of each, sensor → world, at its samples; NaN where not known.
    """
    seen = [
        (one.name, world_field(one.magnetic_field, R))
        for one, R in zip(readings, rotations, strict=True)
        if one.magnetic_field is not None
    ]
    known = [(name, field) for name, field in seen if np.isfinite(field).all()]
    if len(known) < LEAST_SENSORS:
        return ()
    fields = np.array([field for _, field in known])
    usual = most_central(fields)
    sizes = np.linalg.norm(fields, axis=1) / np.linalg.norm(usual)
    cosines = fields @ usual / (np.linalg.norm(fields, axis=1) * np.linalg.norm(usual))
    turns = np.arccos(np.clip(cosines, -1.0, 1.0))
    return tuple(
        StrangeField(name, float(turn), float(size))
        for (name, _), turn, size in zip(known, turns, sizes, strict=True)
        if turn > MOST_TURN_RAD or not SIZES[0] <= size <= SIZES[1]
    )


def world_field(field_ut: Array, rotations: Array) -> Array:
    """(3,) median field in the world, of readings (T, 3) in sensor axes turned by (T, 3, 3)."""
    turned = (rotations @ field_ut[:, :, None])[:, :, 0]
    known = turned[np.isfinite(turned).all(axis=1)]
    return np.median(known, axis=0) if len(known) else np.full(3, np.nan)


def most_central(fields: Array) -> Array:
    """(3,) that of fields (S, 3) to which the others are nearest: least sum of distances."""
    apart = np.linalg.norm(fields[:, None] - fields[None], axis=2)
    return np.asarray(fields[np.argmin(apart.sum(axis=1))])
