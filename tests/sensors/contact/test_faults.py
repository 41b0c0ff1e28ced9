"""Faults that only the samples around show: each is found where it was made, and steep true signals have none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.numerics.runs import runs
from mbkf.sensors.contact.faults import DROP_WEIGHTS, bridged, faults_of
from mbkf.sensors.contact.possible import Fault

RATE_HZ, WEIGHT_N, REACH_M, SAMPLES = 1000.0, 700.0, 0.8, 1200
STANCE = slice(200, 900)


def stance(rate_hz=RATE_HZ, seed=0, noise_n=1.0):
    """One step on a plate in 1.2 s, 0.2 to 0.9 s, with noise: two peaks of 1.1 body weights, zero before and after."""
    t = (np.arange(round(1.2 * rate_hz)) / rate_hz - 0.2) / 0.7
    on = (t > 0.0) & (t < 1.0)
    rise = np.clip(np.minimum(t, 1.0 - t) / 0.15, 0.0, 1.0)
    vertical = WEIGHT_N * rise * (1.0 + 0.12 * np.cos(4.0 * np.pi * (t - 0.25)))
    along = np.stack([0.2 * (t - 0.5), 0.05 * t, 1.0 + 0.0 * t, 0.02 * t, 0.1 * (0.5 - t), 0.005 * t], axis=1)
    noise = np.random.default_rng(seed).normal(scale=noise_n, size=along.shape) * [1, 1, 1, 0.1, 0.1, 0.1]
    return np.where(on[:, None], vertical[:, None] * along + noise, 0.0)


def faults(wrench, rate_hz=RATE_HZ):
    return faults_of(wrench, rate_hz, WEIGHT_N, REACH_M)


def found_at(wrench, kind):
    return np.flatnonzero(faults(wrench) == kind).tolist()


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 300.0, 1000.0, 2000.0])
@pytest.mark.parametrize("noise_n", [0.0, 1.0, 5.0])
def test_a_step_has_no_fault(rate_hz, noise_n):
    assert not faults(stance(rate_hz, noise_n=noise_n), rate_hz).any()


@pytest.mark.parametrize("rate_hz", [100.0, 300.0, 1000.0, 2000.0])
@pytest.mark.parametrize("width_s", [0.008, 0.015, 0.03])
def test_an_impact_of_300_weights_per_second_is_real(rate_hz, width_s):
    wrench = stance(rate_hz)
    t = np.arange(len(wrench)) / rate_hz - 0.25
    peak = 300.0 * 0.5 * width_s * WEIGHT_N
    wrench[:, 2] += peak * np.clip(1.0 - np.abs(t) / (0.5 * width_s), 0.0, None)
    assert not faults(wrench, rate_hz).any()


@settings(deadline=None, max_examples=50)
@given(
    at=st.integers(20, SAMPLES - 40),
    length=st.integers(1, 25),
    channel=st.integers(0, 2),
    height=st.sampled_from([-3.0, 3.0, 5.0, 8.0]),
)
def test_a_spike_is_found_where_it_is_and_nowhere_else(at, length, channel, height):
    wrench = stance()
    wrench[at : at + length, channel] += height * WEIGHT_N
    assert np.flatnonzero(faults(wrench)).tolist() == list(range(at, at + length))


def test_a_jump_that_stays_is_no_spike():
    """A person may land on a plate; a plate may be switched on."""
    wrench = stance()
    wrench[500:880, 2] += 3.0 * WEIGHT_N
    assert not faults(wrench).any()


@settings(deadline=None, max_examples=30)
@given(at=st.integers(330, 700), length=st.integers(1, 80))
def test_zeros_under_a_standing_foot_are_a_dropout(at, length):
    wrench = stance()
    wrench[at : at + length] = 0.0
    assert found_at(wrench, Fault.DROPOUT) == list(range(at, at + length))


def test_a_plate_that_software_zeroes_when_hardly_loaded_has_no_dropout():
    steps = np.concatenate([stance()] * 3)
    steps[steps[:, 2] < 0.9 * DROP_WEIGHTS * WEIGHT_N] = 0.0
    assert not faults(steps).any()


def test_a_loaded_plate_that_repeats_itself_is_stuck():
    wrench = stance()
    wrench[400:] = wrench[400]
    assert found_at(wrench, Fault.STUCK) == list(range(400, SAMPLES))
    assert not faults(np.where(np.arange(SAMPLES)[:, None] < 950, stance(), 0.01 * WEIGHT_N)).any()


def test_what_never_changes_at_all_is_not_judged():
    wrench = np.tile(WEIGHT_N * np.array([0.0, 0.0, 0.5, 0.0, 0.0, 0.0]), (500, 1))
    assert not faults(wrench).any()
    wrench[200] = np.nan
    assert np.flatnonzero(faults(wrench)).tolist() == [200]


@pytest.mark.parametrize("share", [0.7, 0.9, 0.98])
def test_a_top_that_is_cut_off_is_saturated(share):
    wrench = stance()
    limit = share * wrench[:, 2].max()
    over = wrench[:, 2] >= limit
    wrench[:, 2] = np.minimum(wrench[:, 2], limit)
    found = faults(wrench) == Fault.SATURATED
    assert found.any()
    assert not (found & ~over).any()
    assert all(after - first < 5 for first, after in runs(over & ~found))


def test_a_plate_of_the_wrong_sign_is_refused_whole():
    assert (faults(-stance()) == Fault.SIGN).all()
    half = stance()
    half[500:600] *= -1.0
    assert not (faults(half) == Fault.SIGN).any()
    assert (faults(half)[500:600] == Fault.PULL).all()


@pytest.mark.parametrize("rate_hz", [100.0, 1000.0])
def test_a_plate_whose_forces_would_throw_the_body_is_refused_whole(rate_hz):
    """20 times a step of 0.7 s is 12 body weights more than a body bears: 82 m/s."""
    wrench = 20.0 * stance(rate_hz)
    assert (faults(wrench, rate_hz) == Fault.GAIN).all()
    wrench[3] = np.nan
    assert faults(wrench, rate_hz)[3] == Fault.NOT_A_NUMBER
    assert not (faults(6.0 * stance(rate_hz), rate_hz) == Fault.GAIN).any()  # with a load on the shoulders


def test_the_hardest_contacts_throw_nobody():
    """15.2 body weights in the step of a triple jump (0.16 s), 11 in a landing (0.05 s) that ends in standing."""
    t = np.arange(SAMPLES) / RATE_HZ
    for peak, width_s in ((15.2, 0.16), (11.0, 0.05)):
        weights = np.maximum(peak * np.sin(np.pi * np.clip((t - 0.2) / width_s, 0.0, 1.0)), 1.0 * (t > 0.2))
        wrench = np.zeros((SAMPLES, 6))
        wrench[:, 2] = WEIGHT_N * weights + np.random.default_rng(0).normal(size=SAMPLES)
        assert not (faults(wrench) == Fault.GAIN).any()


def test_nothing_but_faults_is_refused_without_an_error():
    assert (faults(np.full((30, 6), np.nan)) == Fault.NOT_A_NUMBER).all()
    assert faults(np.zeros((0, 6))).shape == (0,)
    assert not faults(np.zeros((1, 6))).any()


def test_runs_and_bridges():
    bad = np.array([False, True, True, False, False, True])
    assert runs(bad) == [(1, 3), (5, 6)]
    wrench = np.arange(6.0)[:, None] * np.ones(6)
    broken = np.where(bad[:, None], np.nan, wrench)
    np.testing.assert_allclose(bridged(broken, bad)[:5], wrench[:5], atol=1e-15)
    assert (bridged(broken, bad)[5] == 4.0).all()
    assert bridged(wrench, np.zeros(6, dtype=bool)) is wrench
