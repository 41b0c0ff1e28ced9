"""Inertial sensors through Lab Streaming Layer on this computer: one stream of all, or one of each."""

import threading
import time
import uuid

import numpy as np
import pytest

from mbkf.io.imu.readings import ImuReadings
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl import sensor_grid
from mbkf.stream.lsl.player import LslPlayer
from mbkf.stream.lsl.sensor_source import LslSensorSource
from mbkf.stream.played import played_sensors
from mbkf.stream.replay import ReplaySettings, replay
from tests.stream.reading import connected, read
from tests.waiting import PATIENCE_S, until

PYLSL = lsl()
SENSORS = ("pelvis", "left_thigh", "left_shank")


def sensors(samples=60, rate_hz=100.0):
    rng = np.random.default_rng(0)
    times = np.arange(samples) / rate_hz
    return tuple(
        ImuReadings(name, times, rng.normal(size=(samples, 3)), rng.normal(size=(samples, 3)), None, rate_hz)
        for name in SENSORS
    )


@pytest.fixture
def name():
    """A stream of its own for each test: others may be on this network."""
    return f"mbkf-test-{uuid.uuid4().hex[:8]}"


def play(player, made, speed):
    settings = ReplaySettings(speed, wait_s=PATIENCE_S)
    thread = threading.Thread(target=replay, args=(made, player, settings, threading.Event()))
    thread.start()
    return thread


def test_what_is_sent_arrives_to_the_last_digit(name):
    made = played_sensors(sensors(), "walk")
    player, source = LslPlayer(made, name, 2.0), LslSensorSource([name])
    stream = connected(source)
    assert (stream.trial, stream.sensors, stream.rate_hz) == ("walk", SENSORS, 100.0)
    thread = play(player, made, 2.0)
    frames = read(source, 60)
    thread.join()
    source.close()
    player.close()
    assert [frame.number for frame in frames] == list(range(60))
    np.testing.assert_array_equal([frame.imus for frame in frames], made.imus)
    assert frames[0].markers_m.shape == (0, 3)


def test_a_stream_without_a_counter_is_numbered_by_its_stamps(name):
    info = PYLSL.StreamInfo(name, "IMU", 6, 50.0, PYLSL.cf_float32, name)
    channels = info.desc().append_child("channels")
    for kind, unit in (("acc", "g"), ("gyr", "deg/s")):
        for axis in "xyz":
            one = channels.append_child("channel")
            one.append_child_value("label", f"{kind}_{axis}")
            one.append_child_value("unit", unit)
    outlet, source = PYLSL.StreamOutlet(info), LslSensorSource([name])
    assert connected(source).sensors == (name,)
    until(outlet.have_consumers)
    begin = PYLSL.local_clock()
    for k in (0, 1, 2, 5, 6):  # two are lost
        outlet.push_sample([0.0, 0.0, 1.0, 0.0, 0.0, 180.0], begin + k / 50.0)
    frames = read(source, 5)
    assert [frame.number for frame in frames] == [0, 1, 2, 5, 6]
    np.testing.assert_allclose(frames[0].imus, [[0, 0, np.pi, 0, 0, 9.80665]], rtol=1e-6)
    source.close()
    del outlet


@pytest.mark.slow
def test_a_stream_of_each_sensor_gives_the_same_frames(name, monkeypatch):
    """Each begins at another moment of a sample; readings that are linear in time stay what they are."""
    monkeypatch.setattr(sensor_grid, "LATE_S", PATIENCE_S)  # a busy computer may be late with a few
    names = [f"{name}-{sensor}" for sensor in SENSORS]
    outlets = []
    for one in names:
        info = PYLSL.StreamInfo(one, "IMU", 6, 100.0, PYLSL.cf_double64, one)
        channels = info.desc().append_child("channels")
        for kind, unit in (("acc", "m/s2"), ("gyr", "rad/s")):
            for axis in "xyz":
                channel = channels.append_child("channel")
                channel.append_child_value("label", f"{kind}_{axis}")
                channel.append_child_value("unit", unit)
        outlets.append(PYLSL.StreamOutlet(info))
    source = LslSensorSource(names)
    stream = connected(source)
    assert sorted(stream.sensors) == sorted(names) and stream.rate_hz == 100.0
    until(lambda: all(outlet.have_consumers() for outlet in outlets))
    begin, sent = PYLSL.local_clock(), threading.Event()

    def send():
        for k in range(150):
            for j, outlet in enumerate(outlets):
                at = begin + k / 100.0 + 0.003 * j
                outlet.push_sample([at - begin] * 3 + [-(at - begin)] * 3, at)
            time.sleep(max(0.0, begin + k / 100.0 - PYLSL.local_clock()))
        sent.set()

    thread = threading.Thread(target=send)
    thread.start()
    frames = read(source, 120)
    thread.join()
    assert sent.is_set()
    values = np.array([frame.imus for frame in frames])[20:]
    numbers = np.array([frame.number for frame in frames])[20:]
    assert np.isfinite(values).all()
    # Smoothed stamps differ from those sent by a fraction of a sample.
    slope = np.polyfit(numbers, values[:, 0, 3], 1)[0]
    assert slope == pytest.approx(0.01, rel=0.02)
    np.testing.assert_allclose(values[:, :, 3], values[:, :1, 3] + np.zeros(3), atol=0.004)
    np.testing.assert_allclose(values[:, :, 0], -values[:, :, 3], atol=1e-12)
    source.close()


def test_streams_that_are_not_there_are_waited_for(name):
    assert LslSensorSource([name]).connect(0.3) is None
