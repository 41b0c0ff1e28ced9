"""Streams with stamps of their own as frames: straight lines exactly, faster ones averaged, late ones left out."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mbkf.stream.lsl.sensor_grid import BEGIN_S, LATE_S, SensorGrid


def ramp(stamps, sensors=1):
    """Readings that are linear in time."""
    return np.tile(np.asarray(stamps)[:, None, None], (1, sensors, 6))


def drained(grid, now):
    found = []
    while (one := grid.next(now)) is not None:
        found.append(one)
    return found


@given(st.floats(0.0, 0.01), st.floats(40.0, 130.0), st.floats(1.0, 6.0))
def test_what_is_linear_in_time_is_found_exactly(phase, rate_hz, factor):
    rates = [rate_hz, rate_hz * factor]
    stamps = [5.0 + np.arange(200) / rates[0], 5.0 + phase + np.arange(int(200 * factor)) / rates[1]]
    grid = SensorGrid([1, 2], rates, rate_hz)
    for k, (own, sensors) in enumerate(zip(stamps, (1, 2), strict=True)):
        grid.put(k, own, ramp(own, sensors))
    found = drained(grid, 5.0)
    assert [number for number, _ in found] == list(range(len(found))) and len(found) >= 190
    times = max(one[0] for one in stamps) + np.arange(len(found)) / rate_hz
    values = np.array([readings for _, readings in found])
    inside = slice(2, -2)
    np.testing.assert_allclose(values[inside, 0, 0], times[inside], atol=1e-9)
    np.testing.assert_allclose(values[inside, 1:, 0], times[inside, None] + np.zeros(2), atol=1e-9)


def test_a_frame_waits_for_a_stream_and_then_goes_on_without_it():
    grid = SensorGrid([1, 1], [100.0, 100.0], 100.0)
    stamps = np.arange(20) / 100.0
    grid.put(0, stamps, ramp(stamps))
    grid.put(1, stamps[:10], ramp(stamps[:10]))
    assert len(drained(grid, 0.10)) == 10
    assert grid.next(0.10 + LATE_S - 0.01) is None
    number, found = grid.next(0.10 + LATE_S + 0.02)
    assert number == 10 and np.isfinite(found[0]).all() and np.isnan(found[1]).all()


def test_a_stream_that_never_begins_is_not_waited_for():
    grid = SensorGrid([1, 1], [100.0, 100.0], 100.0)
    stamps = 7.0 + np.arange(200) / 100.0
    grid.put(0, stamps, ramp(stamps))
    assert grid.next(7.0 + BEGIN_S - 0.1) is None
    found = drained(grid, 7.0 + 2.0 + LATE_S)
    assert len(found) == 200 and np.isnan(found[0][1][1]).all()


def test_after_a_silence_frames_go_on_with_their_own_numbers():
    grid = SensorGrid([2], [100.0], 50.0)
    for first in (0.0, 60.0):
        stamps = first + np.arange(100) / 100.0
        grid.put(0, stamps, ramp(stamps, 2))
    found = drained(grid, 61.0)
    numbers = np.array([number for number, _ in found])
    assert len(numbers) < 110 and numbers[-1] > 3000
    values = np.array([readings[0, 0] for _, readings in found])
    known = np.isfinite(values)
    np.testing.assert_allclose(
        values[known], numbers[known] / 50.0, atol=0.0051
    )  # the ends have half a frame


def test_samples_that_go_back_or_come_twice_are_left_out():
    grid = SensorGrid([1], [100.0], 100.0)
    stamps = np.array([0.0, 0.01, 0.01, 0.005, 0.02, np.nan, 0.03])
    grid.put(0, stamps, ramp(stamps))
    grid.put(0, np.array([0.02, 0.04]), ramp([0.02, 0.04]))
    np.testing.assert_allclose(
        [readings[0, 0] for _, readings in drained(grid, 0.0)], np.arange(5) / 100.0, atol=1e-12
    )
