"""Channels of LSL streams as sensors' axes: by label and unit, in any order, those that are missing told."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.sensor_format import read_sensor_info, sensor_info, together
from mbkf.stream.source import StreamDescription

PYLSL = lsl()


def described(name, channels, rate_hz=100.0):
    """A stream of (label, unit, type)."""
    info = PYLSL.StreamInfo(name, "IMU", len(channels), rate_hz, PYLSL.cf_double64, "x")
    node = info.desc().append_child("channels")
    for label, unit, kind in channels:
        one = node.append_child("channel")
        for key, value in (("label", label), ("unit", unit), ("type", kind)):
            one.append_child_value(key, value)
    return info


def axes(kind, unit, sensor=""):
    return [(f"{sensor}{kind}_{axis}", unit, kind) for axis in "xyz"]


def test_what_is_described_is_read_back():
    stream = StreamDescription("walk", (), 104.0, sensors=("pelvis", "left_shank"))
    layout = read_sensor_info(sensor_info(PYLSL, stream, "mbkf"), {})
    assert layout.sensors == stream.sensors and layout.rate_hz == 104.0 and layout.trial == "walk"
    readings = np.random.default_rng(0).normal(size=(5, 2, 6))
    samples = np.column_stack([readings.reshape(5, 12), np.arange(5)])
    np.testing.assert_array_equal(layout.readings(samples), readings)
    assert layout.counter == 12


def test_units_and_order_are_the_makers():
    channels = [("battery", "%", "misc"), *axes("acc", "g"), *axes("gyr", "deg/s"), *axes("mag", "uT")]
    layout = read_sensor_info(described("left_thigh", channels), {})
    sample = np.arange(10.0)[None]
    expected = np.concatenate([np.radians([4.0, 5.0, 6.0]), 9.80665 * np.array([1.0, 2.0, 3.0])])
    np.testing.assert_allclose(layout.readings(sample)[0, 0], expected, rtol=1e-6)
    assert layout.sensors == ("left_thigh",) and layout.counter is None


def test_what_is_missing_blanks_its_own_axis_only():
    channels = [*axes("acc", "m/s2", "a_"), *axes("gyr", "rad/s", "a_"), *axes("acc", "m/s2", "b_"),
                *axes("gyr", "rad/s", "b_"), ("note", "", "misc")]  # fmt: skip
    layout = read_sensor_info(described("x", channels), {})
    sample = np.arange(13.0)[None]
    sample[0, [4, 12]] = np.nan, np.inf
    found = layout.readings(sample)[0]
    np.testing.assert_array_equal(np.argwhere(np.isnan(found)), [[0, 1]])
    np.testing.assert_array_equal(found[1], [9, 10, 11, 6, 7, 8])


def test_a_stream_without_gyroscope_is_none_of_them():
    assert read_sensor_info(described("x", axes("acc", "g")), {}) is None
    assert read_sensor_info(described("x", [("Fp1", "uV", "EEG")]), {}) is None


def test_a_unit_that_is_stated_nowhere_is_asked_for():
    channels = [*axes("acc", ""), *axes("gyr", "rad/s")]
    with pytest.raises(InvalidInput, match="--units acc="):
        read_sensor_info(described("x", channels), {})
    assert read_sensor_info(described("x", channels), {"acc": "g"}) is not None


def test_a_stream_without_a_rate_is_refused():
    with pytest.raises(InvalidInput, match="states no rate"):
        read_sensor_info(described("x", [*axes("acc", "g"), *axes("gyr", "rad/s")], 0.0), {})


def test_several_streams_have_the_rate_of_the_slowest_and_names_of_their_own():
    imu = [*axes("acc", "g"), *axes("gyr", "rad/s")]
    layouts = [
        read_sensor_info(described(name, imu, rate), {}) for name, rate in (("a", 400.0), ("b", 148.0))
    ]
    found = together(layouts)
    assert found.sensors == ("a", "b") and found.rate_hz == 74.0
    with pytest.raises(InvalidInput, match="two LSL streams bring a sensor 'a'"):
        together([layouts[0], layouts[0]])
