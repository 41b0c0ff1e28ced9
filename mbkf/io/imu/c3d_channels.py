"""Analog channels of C3D files that are inertial sensors', as camera systems record them beside markers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mbkf.errors import FileFormatError
from mbkf.io.c3d_analog import analog_channels
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.imu.channels import Channel, channel_signals
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import readings_of


def read_c3d_sensors(path: Path, units: Mapping[str, str] | None = None) -> tuple[ImuReadings, ...]:
    """The sensors of a file, on the clock of its markers: frame 1 is at 0 s.

    Labels name sensor, quantity and axis ("Left Foot.ACC.X", "ACCX1"), the file's parameters the unit; ``units`` hold
    where the file states no unit, or volts.

    Raises:
        FileFormatError: The file is missing or damaged, or has no channels of an accelerometer.
        InvalidInput: A unit is not stated.
        UnknownName: Unknown unit.
    """
    content = decode(path, check_layout(path))
    channels = analog_channels(content)
    if not channels:
        raise FileFormatError(path, "no analog channels; export those of the inertial sensors, too")
    rate_hz = channels[0].rate_hz
    times = max(content.first_frame - 1, 0) / content.rate_hz + np.arange(len(channels[0].values)) / rate_hz
    signals = channel_signals(
        path, [Channel(one.name, one.unit, one.values) for one in channels], times, units=units
    )
    if not signals:
        raise FileFormatError(
            path, "no analog channel is an inertial sensor's, by its label (such as 'Left Foot.ACC.X')"
        )
    return readings_of(path, signals, rate_hz)
