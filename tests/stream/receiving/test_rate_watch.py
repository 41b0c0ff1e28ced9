"""Frames at another rate than their stream states are told of, and bursts, losses and jitter are not taken for one."""

import numpy as np
import pytest

from mbkf.stream.receiving.rate_watch import RateWatch


def told(arrivals_s, numbers):
    watch = RateWatch(100.0)
    found = [watch.arrived(at, n) for at, n in zip(arrivals_s, numbers, strict=True)]
    return [one for one in found if one is not None]


def numbered_by_time(arrivals_s):
    """Numbers as time stamps give them; None for those that are taken."""
    found, last = [], -1
    for at in arrivals_s:
        number = round(100.0 * at)
        found.append(number if number > last else None)
        last = max(number, last)
    return found


@pytest.mark.parametrize("rate_hz", [30.0, 85.0, 115.0, 300.0])
def test_another_rate_is_found_by_the_count(rate_hz):
    found = told(np.arange(int(2.5 * rate_hz)) / rate_hz, range(int(2.5 * rate_hz)))
    assert found[0] == pytest.approx(rate_hz, rel=0.01)


@pytest.mark.parametrize("rate_hz", [30.0, 48.0, 120.0, 300.0])
def test_another_rate_is_found_by_arrivals_where_time_numbers_the_frames(rate_hz):
    arrivals_s = np.arange(int(2.5 * rate_hz)) / rate_hz
    assert told(arrivals_s, numbered_by_time(arrivals_s))[0] == pytest.approx(rate_hz, rel=0.03)


@pytest.mark.parametrize("seed", range(5))
def test_jitter_and_losses_are_no_other_rate(seed):
    rng = np.random.default_rng(seed)
    numbers = np.flatnonzero(rng.uniform(size=1000) > 0.5)
    arrivals_s = np.maximum.accumulate(numbers / 100.0 + rng.uniform(0.0, 0.05, len(numbers)))
    assert told(arrivals_s, numbers.tolist()) == []


def test_pauses_and_bursts_are_no_other_rate():
    at = np.arange(1000) / 100.0
    arrivals_s = np.where(
        at % 2.0 < 0.5, at - at % 2.0 + 0.5, at
    )  # half a second held back, then all at once
    assert told(arrivals_s, range(1000)) == []
    assert told(np.maximum(at, 2.0), range(1000)) == []


def test_windows_in_which_no_frame_has_a_number_state_no_rate():
    watch = RateWatch(100.0)
    assert [watch.arrived(0.01 * k, 0 if k == 0 else None) for k in range(400)] == [None] * 400
