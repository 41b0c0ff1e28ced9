"""Format of inertial sensors in Lab Streaming Layer: channels of a stream as axes of sensors.

Channels are read as those of a recording (:mod:`mbkf.io.imu.channels`): their labels name sensor, quantity and axis
("left_shank_gyr_x"), their units the unit. A sensor whose channels do not name it has the name of its stream, so that
one stream of eight sensors and eight streams of one are the same. A channel of type "FrameNumber" counts samples.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.channels import Channel, channel_signals
from mbkf.stream.identity import Columns
from mbkf.stream.lsl.format import (
    StreamInfo,
    counter_channel,
    counter_of,
    described_channels,
    new_info,
)
from mbkf.stream.source import StreamDescription
from mbkf.trial.inertial.motion_inputs import MOST_HZ

SENSOR_TYPE = "IMU"
SENSOR_TYPES = ("imu", "inertial", "mocap", "motion", "accelerometer", "sensor", "sensors", "wearable")
"""Types of streams that are looked into where no name is given, in lower case."""

_UNITS = (("gyr", "rad/s"), ("acc", "m/s2"))


@dataclass(frozen=True)
class SensorLayout:
    """Channel layout of a stream of inertial sensors.

    Attributes:
        sensors: (S,) the sensors.
        to_readings: (6 S, C) from a sample's channels to angular velocity rad/s and specific force m/s² of each.
        counter: Channel that counts samples, None where there is none.
        rate_hz: Nominal rate.
        trial: Name of the played trial, or of the stream.
    """

    sensors: tuple[str, ...]
    to_readings: Array
    counter: int | None
    rate_hz: float
    trial: str

    def reordered(self, places: Columns) -> SensorLayout:
        """The layout with sensors in another order, by their (S,) places in this one."""
        rows = self.to_readings.reshape(len(self.sensors), 6, -1)[places]
        sensors = tuple(self.sensors[k] for k in places)
        return replace(self, sensors=sensors, to_readings=rows.reshape(6 * len(sensors), -1))

    def readings(self, samples: Array) -> Array:
        """(T, S, 6) of samples (T, C); a missing channel is NaN in its own axis only."""
        finite = np.isfinite(samples)
        found = np.where(finite, samples, 0.0) @ self.to_readings.T
        if not finite.all():
            found[(~finite).astype(float) @ (self.to_readings != 0.0).T > 0.0] = np.nan
        return np.asarray(found.reshape(len(samples), len(self.sensors), 6))


def sensor_info(lsl: ModuleType, stream: StreamDescription, name: str) -> StreamInfo:
    """The stream information of inertial sensors.

    Args:
        lsl: The module pylsl.
        stream: Sensors and rate.
        name: Name of the LSL stream.
    """
    channels = [
        {"label": f"{sensor}_{kind}_{axis}", "type": kind, "unit": unit}
        for sensor in stream.sensors
        for kind, unit in _UNITS
        for axis in "xyz"
    ]
    return new_info(lsl, stream, name, SENSOR_TYPE, [*channels, counter_channel("sample")])


def read_sensor_info(info: StreamInfo, units: Mapping[str, str]) -> SensorLayout | None:
    """The channel layout of a stream; None where no sensor in it has an accelerometer and a gyroscope.

    ``units`` are those that channels do not state.

    Raises:
        InvalidInput: The stream states no rate, or a unit is stated nowhere.
        UnknownName: Unknown unit.
    """
    channels = described_channels(info)
    where = f"LSL stream '{info.name()}'"
    # Channels as unit vectors: their signals are the columns of the map to readings.
    unit_vectors = np.eye(info.channel_count())
    signals = channel_signals(
        Path(where),
        [
            Channel(one["label"], one["unit"], column)
            for one, column in zip(channels, unit_vectors, strict=False)
        ],
        np.arange(len(unit_vectors), dtype=float),
        units=units,
        sensor=info.name(),
    )
    by_kind = {(one.sensor, one.kind): one.values.T for one in signals}
    names = [sensor for sensor, kind in by_kind if kind == "acc" and (sensor, "gyr") in by_kind]
    if not names:
        return None
    if not info.nominal_srate() > 0.0:
        raise InvalidInput(f"{where} states no rate; the filter needs a regular one")
    rows = [by_kind[name, kind] for name in names for kind in ("gyr", "acc")]
    counter = counter_of(channels)
    trial = info.desc().child_value("trial") or info.name()
    return SensorLayout(tuple(names), np.concatenate(rows), counter, float(info.nominal_srate()), trial)


def together(layouts: Sequence[SensorLayout]) -> StreamDescription:
    """Common frames of several streams: as many a second as the slowest one sends, or a whole part of that.

    Raises:
        InvalidInput: Two streams bring a sensor of the same name.
    """
    names = [name for one in layouts for name in one.sensors]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InvalidInput(f"two LSL streams bring a sensor '{twice[0]}'; choose one of them with --stream")
    rate_hz = min(one.rate_hz for one in layouts)
    rate_hz /= max(1.0, np.ceil(rate_hz / MOST_HZ))
    return StreamDescription(layouts[0].trial, (), rate_hz, sensors=tuple(names))
