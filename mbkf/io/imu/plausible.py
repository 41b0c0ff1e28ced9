"""Impossible readings of inertial sensors are refused: a thousand times gravity, times that go back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.plausible import RATES_HZ

MOST_MPS2, MOST_RAD_S, MOST_UT = 1e4, 1e3, 1e6
"""Sensors for high accelerations end at 400 g, gyroscopes at 70 rad/s; strong magnets have 1 T."""


def plausible_readings(sensors: Sequence[ImuReadings], where: str) -> tuple[ImuReadings, ...]:
    """The sensors of a file, unless one of them reads an impossible value.

    Raises:
        InvalidInput: A rate, a time or a reading is impossible; names sensor and sample.
    """
    for one in sensors:
        name = f"{where}: sensor {one.name}"
        if not RATES_HZ[0] <= one.rate_hz <= RATES_HZ[1]:
            raise InvalidInput(
                f"{name}: its rate is {one.rate_hz:g} Hz; correct the times or give the rate with --rate"
            )
        wrong = ~np.isfinite(one.time_s)
        wrong[1:] |= ~(np.diff(one.time_s) >= 0.0)
        if wrong.any():
            first = int(np.argmax(wrong)) + 1
            raise InvalidInput(
                f"{name}: the time of sample {first} goes back or is missing; export the file again"
            )
        for quantity, values, most, unit in (
            ("an acceleration", one.specific_force_mps2, MOST_MPS2, "m/s²"),
            ("an angular velocity", one.angular_velocity_rad_s, MOST_RAD_S, "rad/s"),
            ("a magnetic field", one.magnetic_field, MOST_UT, "µT"),
            ("a quaternion", one.orientation, 2.0, ""),
        ):
            if values is None:
                continue
            far = (np.abs(values) > most).any(axis=1)
            if far.any():
                sample = int(np.argmax(far))
                largest = float(np.nanmax(np.abs(values[sample])))
                raise InvalidInput(
                    f"{name} reads {quantity} of {largest:.2g} {unit}".rstrip()
                    + f" in sample {sample + 1}; correct its unit or blank the sample"
                )
    return tuple(sensors)
