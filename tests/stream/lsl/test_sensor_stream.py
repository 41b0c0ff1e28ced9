"""A stream of inertial sensors that breaks off and returns with its channels in another order, or as another one."""

import uuid

import numpy as np
import pytest

from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.sensor_format import read_sensor_info
from mbkf.stream.lsl.sensor_stream import SensorStream
from tests import waiting

PYLSL = lsl()


def info_of(name, sensors, rate_hz=50.0, unit="rad/s", counted=False):
    """A stream of sensors; the first axis of each accelerometer tells which sensor it is."""
    info = PYLSL.StreamInfo(
        name, "IMU", 6 * len(sensors) + counted, rate_hz, PYLSL.cf_double64, f"{name}{sensors}"
    )
    channels = info.desc().append_child("channels")
    for sensor in sensors:
        for kind, own in (("gyr", unit), ("acc", "m/s2")):
            for axis in "xyz":
                one = channels.append_child("channel")
                one.append_child_value("label", f"{sensor}_{kind}_{axis}")
                one.append_child_value("unit", own)
    if counted:
        channels.append_child("channel").append_child_value("type", "FrameNumber")
    return info


def row(*readings):
    """Channels of sensors with an angular velocity and a specific force each, along x."""
    return [value for gyr, acc in readings for value in (gyr, 0.0, 0.0, acc, 0.0, 0.0)]


@pytest.fixture
def name():
    return f"mbkf-test-{uuid.uuid4().hex[:8]}"


def received(name, info, news, counted=False):
    (found,) = waiting.until(lambda: PYLSL.resolve_byprop("name", name, 1, 5.0))
    layout = read_sensor_info(info, {})
    return SensorStream(PYLSL, found, layout, {}, counted, lambda kind, what: news.append((kind, what)))


def until(news, kind, stream):
    """Reads until an event of a kind has come."""
    waiting.until(lambda: stream.take(0.02) or kind in [known for known, _ in news], lambda: news)


def test_samples_have_numbers_and_times_by_their_stamps(name):
    info, news = info_of(name, ("a", "b")), []
    outlet = PYLSL.StreamOutlet(info)
    stream = received(name, info, news)
    waiting.until(outlet.have_consumers)
    begin = PYLSL.local_clock()
    for n in (0, 1, 2, 5, 6):
        outlet.push_sample(row((n, 1.0), (n, 2.0)), begin + n / 50.0)
    # They wait for more, until a look finds no other.
    waiting.until(lambda: stream.take(0.0) or stream._stamped.numbering.waiting == 5)
    found = stream.take(0.1)
    assert found.numbers.tolist() == [0, 1, 2, 5, 6]
    np.testing.assert_allclose(found.times_s - begin, found.numbers / 50.0, atol=2e-3)
    np.testing.assert_array_equal(found.values[:, :, 3], np.tile([1.0, 2.0], (5, 1)))


@pytest.mark.slow
def test_sensors_that_return_in_another_order_and_unit_are_found_by_name(name):
    info, news = info_of(name, ("a", "b"), counted=True), []
    outlet = PYLSL.StreamOutlet(info)
    stream = received(name, info, news, counted=True)
    waiting.until(outlet.have_consumers)
    outlet.push_sample([*row((1.0, 10.0), (2.0, 20.0)), 4.0])
    first = stream.take(waiting.PATIENCE_S)
    assert first.numbers.tolist() == [4] and first.values[0, :, 0].tolist() == [1.0, 2.0]
    del outlet
    again = PYLSL.StreamOutlet(info_of(name, ("b", "a"), unit="deg/s", counted=True))
    until(news, "sensors back", stream)
    waiting.until(again.have_consumers)
    again.push_sample([*row((180.0, 20.0), (90.0, 10.0)), 9.0])
    found = stream.take(waiting.PATIENCE_S)
    assert found.numbers.tolist() == [9]
    np.testing.assert_allclose(found.values[0, :, 0], [np.pi / 2.0, np.pi])
    np.testing.assert_allclose(found.values[0, :, 3], [10.0, 20.0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sensors", "rate_hz", "reason"),
    [(("a", "c"), 50.0, "1 of 2 are missing: b"), (("a", "b"), 100.0, "another rate")],
)
def test_another_stream_of_its_name_is_refused(name, sensors, rate_hz, reason):
    info, news = info_of(name, ("a", "b")), []
    outlet = PYLSL.StreamOutlet(info)
    stream = received(name, info, news)
    del outlet
    other = PYLSL.StreamOutlet(info_of(name, sensors, rate_hz))
    until(news, "refused", stream)
    assert reason in dict(news)["refused"]
    del other
