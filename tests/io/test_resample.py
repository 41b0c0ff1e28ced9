"""Means over frames against integrals known in closed form."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.io.records import PlateReadings
from mbkf.io.resample import average_over_frames


def plate_of(values: np.ndarray, rate_hz: float, start_s: float = 0.0) -> PlateReadings:
    samples = len(values)
    return PlateReadings(
        "1", rate_hz, start_s, np.zeros(3), values, -2.0 * values, np.full((samples, 3), np.nan), 20.0
    )


@given(
    rate_hz=st.sampled_from([60.0, 90.0, 100.0, 1000.0, 1234.5]),
    frame_rate_hz=st.sampled_from([50.0, 100.0, 120.0]),
    slope=st.floats(-100, 100),
    start_s=st.floats(-2, 5),
)
def test_a_straight_line_keeps_its_value_at_the_frame(rate_hz, frame_rate_hz, slope, start_s):
    t = start_s + np.arange(int(rate_hz)) / rate_hz
    plate = plate_of(slope * (t - start_s)[:, None] * [1.0, 2.0, 3.0] + 5.0, rate_hz, start_s)
    frames = start_s + 0.1 + np.arange(40) / frame_rate_hz
    loads = average_over_frames(plate, frames, frame_rate_hz)
    expected = slope * (frames - start_s)[:, None] * [1.0, 2.0, 3.0] + 5.0
    np.testing.assert_allclose(loads.force_n, expected, atol=1e-7)
    np.testing.assert_allclose(loads.moment_nm, -2.0 * expected, atol=1e-7)


def test_mean_of_a_sine_is_its_integral_over_the_window():
    rate_hz, frame_rate_hz, w = 20000.0, 100.0, 2 * np.pi * 7.0
    t = np.arange(20000) / rate_hz
    frames = np.arange(5, 90) / frame_rate_hz
    loads = average_over_frames(plate_of(np.sin(w * t)[:, None] * np.ones(3), rate_hz), frames, frame_rate_hz)
    h = 0.5 / frame_rate_hz
    exact = (np.cos(w * (frames - h)) - np.cos(w * (frames + h))) / (2 * h * w)
    np.testing.assert_allclose(loads.force_n[:, 0], exact, atol=1e-6)


def test_impulse_is_conserved():
    rng = np.random.default_rng(0)
    values = np.zeros((1001, 3))
    values[100:900] = rng.normal(500.0, 100.0, (800, 3))
    frames = np.arange(101) / 100.0
    loads = average_over_frames(plate_of(values, 1000.0), frames, 100.0)
    trapezia = (values[1:] + values[:-1]).sum(axis=0) / 2000.0
    np.testing.assert_allclose(loads.force_n.sum(axis=0) / 100.0, trapezia, rtol=1e-12)


def test_frames_outside_the_recording_are_missing():
    plate = plate_of(np.ones((100, 3)), 1000.0, start_s=1.0)
    frames = np.array([0.0, 0.999, 0.9996, 1.0, 1.05, 1.099, 1.0994, 1.1, 2.0])
    loads = average_over_frames(plate, frames, 100.0)
    np.testing.assert_array_equal(
        np.isnan(loads.force_n[:, 0]), [True, True, False, False, False, False, False, True, True]
    )
    np.testing.assert_allclose(loads.force_n[2:7], 1.0)


@pytest.mark.parametrize("samples", [0, 1])
def test_recordings_of_hardly_anything(samples):
    loads = average_over_frames(plate_of(np.full((samples, 3), 4.0), 1000.0), np.array([0.0, 0.5]), 100.0)
    assert np.isnan(loads.force_n[1]).all()
    if samples:
        np.testing.assert_array_equal(loads.force_n[0], 4.0)
    else:
        assert np.isnan(loads.force_n).all()


def test_equal_rates_weigh_neighbours():
    values = np.array([[0.0] * 3, [8.0] * 3, [0.0] * 3])
    loads = average_over_frames(plate_of(values, 100.0), np.array([0.01]), 100.0)
    np.testing.assert_allclose(loads.force_n, [[6.0] * 3])
