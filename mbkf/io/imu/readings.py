"""Readings of inertial sensors as an immutable record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import InvalidInput, ShapeError

_MOST_GAPS = 3


@dataclass(frozen=True)
class ImuReadings:
    """Readings of one inertial sensor, in its own axes.

    Attributes:
        name: Sensor name, e.g. the segment that carries it.
        time_s: (T,) sample times, s.
        specific_force_mps2: (T, 3) accelerometer: acceleration minus gravity, m/s²; at rest it points up.
        angular_velocity_rad_s: (T, 3) gyroscope, rad/s; NaN throughout where the file has none.
        magnetic_field: (T, 3) magnetometer, µT; None where there is none.
        rate_hz: Nominal sample rate.
        frame: A note on the sensor's axes or the file's world frame, "" where nothing is known.
        orientation: (T, 4) sensor → world as unit quaternions (x, y, z, w) where the file brings one (an optical
            reference, or the maker's own filter), else None; ``frame`` names that world.
        moving: (T,) samples that the file marks as those of a movement; None where it marks none.

    Missing samples are NaN.
    """

    name: str
    time_s: Array
    specific_force_mps2: Array
    angular_velocity_rad_s: Array
    magnetic_field: Array | None
    rate_hz: float
    frame: str = ""
    orientation: Array | None = None
    moving: BoolArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_s", read_only(self.time_s))
        if self.time_s.ndim != 1:
            raise ShapeError("time_s", "(T,)", self.time_s.shape)
        vectors = ("specific_force_mps2", "angular_velocity_rad_s", "magnetic_field")
        for name, width in (*((name, 3) for name in vectors), ("orientation", 4)):
            value = getattr(self, name)
            if value is None:
                continue
            array = read_only(value)
            if array.shape != (len(self.time_s), width):
                raise ShapeError(name, f"({len(self.time_s)}, {width})", array.shape)
            object.__setattr__(self, name, array)
        if self.moving is not None:
            flags = np.array(self.moving, dtype=bool)
            flags.flags.writeable = False
            if flags.shape != self.time_s.shape:
                raise ShapeError("moving", f"({len(self.time_s)},)", flags.shape)
            object.__setattr__(self, "moving", flags)
        if not (np.isfinite(self.rate_hz) and self.rate_hz > 0.0):
            raise InvalidInput(f"sensor {self.name}: the rate must be positive, got {self.rate_hz} Hz")

    def at(
        self, time_s: Array, pick: Callable[[Array, str], Array], moving: BoolArray | None = None
    ) -> ImuReadings:
        """The readings at other times.

        Args:
            time_s: (T',) the times, s.
            pick: Values (T', n) of a quantity at these times, from its values (T, n) and kind ("acc", "gyr", "mag" or
                "quat").
            moving: (T',) samples of a movement.
        """
        field, turn = self.magnetic_field, self.orientation
        return replace(
            self,
            time_s=time_s,
            specific_force_mps2=pick(self.specific_force_mps2, "acc"),
            angular_velocity_rad_s=pick(self.angular_velocity_rad_s, "gyr"),
            magnetic_field=None if field is None else pick(field, "mag"),
            orientation=None if turn is None else pick(turn, "quat"),
            moving=moving,
        )

    @property
    def samples(self) -> int:
        """Number of samples T."""
        return len(self.time_s)


def on_regular_grid(one: ImuReadings) -> ImuReadings:
    """The readings at times that are a whole number of steps apart; lost samples become missing ones.

    Raises:
        InvalidInput: The times do not increase, or gaps make up most of the recording.
    """
    row = np.round((one.time_s - one.time_s[0]) * one.rate_hz).astype(int)
    if len(row) == row[-1] + 1 and (np.diff(row) == 1).all():
        return one
    if (np.diff(one.time_s) <= 0.0).any():
        raise InvalidInput(f"sensor {one.name}: its times do not increase; sort the file")
    count = int(row[-1]) + 1
    if count > _MOST_GAPS * len(row):
        raise InvalidInput(
            f"sensor {one.name}: {count - len(row)} of {count} samples are missing; check the rate"
        )
    known, first = np.unique(row, return_index=True)

    def spread(values: Array, _kind: str) -> Array:
        grid = np.full((count, values.shape[1]), np.nan)
        grid[known] = values[first]
        return grid

    moving = None
    if one.moving is not None:
        moving = np.zeros(count, dtype=bool)
        moving[known] = one.moving[first]
    return one.at(one.time_s[0] + np.arange(count) / one.rate_hz, spread, moving)


def rate_of(time_s: Array, where: str) -> float:
    """Sample rate, Hz, from the usual step between times (T,), which gaps do not change.

    Raises:
        InvalidInput: The times do not increase.
    """
    steps = np.diff(time_s[np.isfinite(time_s)])
    usual = float(np.median(steps)) if len(steps) else 0.0
    if usual <= 0.0:
        raise InvalidInput(f"{where}: the times do not increase; give the rate with --rate")
    regular = steps[np.abs(steps - usual) < 0.5 * usual]
    return 1.0 / float(regular.mean() if len(regular) else usual)


def between(one: ImuReadings, first_s: float, last_s: float) -> ImuReadings:
    """The readings from one time to another, s, without orientations.

    Args:
        one: The readings.
        first_s: The first time.
        last_s: The last one.
    """
    kept = (one.time_s >= first_s - 1e-9) & (one.time_s <= last_s + 1e-9)
    return replace(one, orientation=None).at(one.time_s[kept], lambda values, _: values[kept])
