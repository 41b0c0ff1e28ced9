"""Magnetic fields compared between sensors, to find a magnetometer whose field differs from the others'.

Where the body's motion is known without magnetometers, it gives the attitude of each sensor. Turned into the world with
it, all sensors of a person see one field, but for iron nearby. One that sees it from elsewhere, or of another size, is
named (:func:`disturbed_fields`). Before a motion is known, gyroscope and accelerometer give a sensor's attitude but for
its heading: all fields are as strong and as steep, and legs whose headings come from their fields swing about one
level axis, in one sense (:func:`fields_unlike_others`). Neither depends on how sensors are strapped on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.imu.readings import ImuReadings

LEAST_SENSORS = 3
"""Fewer fields leave open which of them is wrong."""

MOST_TURN_RAD = 0.45
"""A field further from the others' than this is another one; indoors fields differ by some 15°."""

MOST_ASKEW_RAD = 0.7
"""A leg's side-to-side axis further from the others' than this is turned by its field: toes point outwards by less."""

SIZES = (0.6, 1.6)
"""Sizes of a field, as a share of the others', that indoor fields have."""


@dataclass(frozen=True)
class Swing:
    """Level axis about which a segment swings, in the world of its sensor's field.

    Attributes:
        axis_rad: Direction of the axis about the vertical.
        points_left: The axis points to the left; otherwise it may point to the right as well.
    """

    axis_rad: float
    points_left: bool


@dataclass(frozen=True)
class DisturbedField:
    """A magnetometer whose field differs from the others'.

    Attributes:
        sensor: Its name.
        turn_rad: Angle between its field and the others'.
        size: Its size as a share of theirs.
    """

    sensor: str
    turn_rad: float
    size: float

    @property
    def remark(self) -> str:
        """The finding in one sentence."""
        return (
            f"magnetometer of {self.sensor}: its field is turned by {np.degrees(self.turn_rad):.0f} deg against the "
            f"other sensors' and has {self.size:.2f} of its size; it is left out"
        )


def disturbed_fields(
    readings: Sequence[ImuReadings], rotations: Sequence[Array]
) -> tuple[DisturbedField, ...]:
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
    return _named([name for name, _ in known], turns, sizes)


def fields_unlike_others(
    readings: Sequence[ImuReadings], free: Sequence[Array], swing: Sequence[Swing | None]
) -> tuple[DisturbedField, ...]:
    """Magnetometers whose field has another size or dip than the others', or a heading by which its leg swings askew.

    Args:
        readings: Sensors with magnetometers.
        free: (T, 3, 3) of each, sensor → a world of its own, z up, without its magnetometer.
        swing: Swing of each segment; None: it does not swing.
    """
    parts = [
        _level_and_up(one.magnetic_field, R)
        for one, R in zip(readings, free, strict=True)
        if one.magnetic_field is not None
    ]
    if len(parts) != len(readings) or len(parts) < LEAST_SENSORS or not all(len(one) for one in parts):
        return ()
    fields = np.array([np.median(one, axis=0) for one in parts])
    usual = most_central(fields)
    sizes = np.linalg.norm(fields, axis=1) / np.linalg.norm(usual)
    turns = np.abs(np.arctan2(fields[:, 1], fields[:, 0]) - np.arctan2(usual[1], usual[0]))
    # A magnetometer whose axes are turned sees the field dip otherwise in every attitude.
    apart = [
        np.sqrt(np.mean(np.sum((own - field) ** 2, axis=1))) for own, field in zip(parts, fields, strict=True)
    ]
    turns = np.maximum(turns, np.arctan2(apart, np.linalg.norm(usual)))
    askew = _askew(swing)
    turns = np.where(askew > MOST_ASKEW_RAD, askew, turns)
    return _named([one.name for one in readings], turns, sizes)


def _level_and_up(field_ut: Array, rotations: Array) -> Array:
    """(n, 2) level and upward part of the known ones of readings (T, 3), turned by (T, 3, 3)."""
    turned = (rotations @ field_ut[:, :, None])[:, :, 0]
    known = turned[np.isfinite(turned).all(axis=1)]
    return np.column_stack([np.hypot(known[:, 0], known[:, 1]), known[:, 2]])


def _askew(swing: Sequence[Swing | None]) -> Array:
    """(S,) angles, rad, between axes and the one that others are nearest to; 0 with fewer than three.

    Of axes that point to the left most do so: one that does not is turned by more than a right angle.
    """
    known = [(k, one) for k, one in enumerate(swing) if one is not None]
    found = np.zeros(len(swing))
    if len(known) < LEAST_SENSORS:
        return found
    angles = np.array([one.axis_rad for _, one in known])
    axis = 0.5 * np.arctan2(
        *most_central(np.column_stack([np.cos(2.0 * angles), np.sin(2.0 * angles)]))[::-1]
    )
    along = np.cos(angles - axis)
    senses = np.sign(along) * [one.points_left for _, one in known]
    most = np.sign(senses.sum()) if abs(senses.sum()) >= 2 else 0.0
    cosines = np.where(senses * most < 0.0, -np.abs(along), np.abs(along))
    found[[k for k, _ in known]] = np.arccos(np.clip(cosines, -1.0, 1.0))
    return found


def _named(names: Sequence[str], turns: Array, sizes: Array) -> tuple[DisturbedField, ...]:
    """Those whose field is too far from the others'; empty where most of them differ.

    Args:
        names: (S,) sensors.
        turns: (S,) angles between each one's field and the others', rad.
        sizes: (S,) sizes as shares of theirs.
    """
    found = tuple(
        DisturbedField(name, float(turn), float(size))
        for name, turn, size in zip(names, turns, sizes, strict=True)
        if turn > MOST_TURN_RAD or not SIZES[0] <= size <= SIZES[1]
    )
    return found if 2 * len(found) < len(names) else ()


def world_field(field_ut: Array, rotations: Array) -> Array:
    """(3,) median field in the world, of readings (T, 3) in sensor axes turned by (T, 3, 3)."""
    turned = (rotations @ field_ut[:, :, None])[:, :, 0]
    known = turned[np.isfinite(turned).all(axis=1)]
    return np.median(known, axis=0) if len(known) else np.full(3, np.nan)


def most_central(fields: Array) -> Array:
    """(3,) that of fields (S, 3) to which the others are nearest: least sum of distances."""
    apart = np.linalg.norm(fields[:, None] - fields[None], axis=2)
    return np.asarray(fields[np.argmin(apart.sum(axis=1))])
