"""Rounded stamps and stamps of packets lie on a line; lost samples stay lost."""

import numpy as np
import pytest

from mbkf.io.imu.even_times import even_times
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import rate_of

ROWS = np.arange(1200)


def packets(size, rate_hz):
    """Stamps at which packets of a sensor's samples arrive."""
    return (ROWS // size + 1.0) * size / rate_hz


@pytest.mark.parametrize("rate_hz", [30.0, 60.0, 128.0, 163.2, 400.0])
def test_stamps_in_whole_milliseconds_give_the_rate_of_all_of_them(rate_hz):
    times = even_times(np.round(7.0 + ROWS / rate_hz, 3))
    assert rate_of(times, "") == pytest.approx(rate_hz, rel=1e-4)
    np.testing.assert_allclose(times, 7.0 + ROWS / rate_hz, atol=1.1e-3)


@pytest.mark.parametrize("size", [2, 4, 10])
def test_packets_with_one_stamp_are_spread_over_their_samples(size):
    times = even_times(packets(size, 100.0))
    np.testing.assert_allclose(np.diff(times), 0.01, rtol=1e-3)
    assert rate_of(times, "") == pytest.approx(100.0, rel=1e-4)


def test_a_packet_that_comes_late_loses_nothing():
    stamps = packets(4, 100.0)
    stamps[600:604] += 0.03
    np.testing.assert_allclose(np.diff(even_times(stamps)), 0.01, rtol=1e-3)


@pytest.mark.parametrize(
    ("stamps", "gaps"),
    [
        (np.delete(np.round(ROWS / 128.0, 3), [500, 501, 900]), {499: 3, 897: 2}),
        (np.delete(packets(10, 100.0), range(400, 420)), {399: 21}),
        (np.delete(packets(4, 100.0), range(400, 404)), {399: 5}),
    ],
)
def test_samples_that_are_really_lost_leave_gaps(stamps, gaps):
    steps = np.diff(even_times(stamps))
    whole = np.round(steps / np.median(steps), 3)
    assert {int(k): whole[k] for k in np.flatnonzero(whole != 1.0)} == gaps


def test_a_stated_rate_holds_between_stamps_of_packets_and_where_stamps_go_back():
    np.testing.assert_allclose(np.diff(even_times(packets(4, 100.0), 101.0)), 1.0 / 101.0)
    back = ROWS / 100.0
    back[700:] -= 3.0
    np.testing.assert_allclose(np.diff(even_times(back, 50.0)), 0.02)
    np.testing.assert_array_equal(even_times(back), back)


def test_regular_stamps_and_clocks_that_wander_stay_as_they_are():
    regular = np.delete(ROWS / 64.0, range(20, 35))
    np.testing.assert_array_equal(even_times(regular), regular)
    wandering = np.round(ROWS / 128.0 + 0.5 * np.sin(ROWS / 200.0), 3)
    np.testing.assert_array_equal(even_times(wandering), wandering)


def test_real_clocks_rounded_and_buffered(real_data):
    (rounded,) = read_imu(real_data / "strangers3" / "ms_rounded_clock_163Hz.csv")
    assert rounded.rate_hz == pytest.approx(163.2, abs=0.2)
    folder = real_data / "strangers3"
    (buffered,) = read_imu(folder / "xio_short_walk_buffered_stamps_15s.csv")
    assert buffered.rate_hz == pytest.approx(397.7, abs=1.0)
    assert (np.diff(buffered.time_s) > 0.0).all()
    (stated,) = read_imu(folder / "xio_short_walk_buffered_stamps_15s.csv", rate_hz=400.0)
    assert stated.rate_hz == 400.0
