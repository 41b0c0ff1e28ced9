"""A stream that comes at another rate than it states is told apart from one that loses frames or pauses."""

import pytest

from mbkf.stream.receiving.rate import WATCHED_S, RateWatch


def told(pairs):
    watch = RateWatch(100.0)
    return [rate for number, at in pairs if (rate := watch.unlike(number, at)) is not None]


def frames(rate_hz, seconds, step=1):
    return [(step * k, k / rate_hz) for k in range(int(rate_hz * seconds))]


@pytest.mark.parametrize("rate_hz", [95.0, 100.0, 105.0])
def test_the_stated_rate_is_no_event(rate_hz):
    assert told(frames(rate_hz, 20.0)) == []


@pytest.mark.parametrize("rate_hz", [30.0, 80.0, 300.0])
def test_another_rate_is_told_once_a_while(rate_hz):
    found = told(frames(rate_hz, 4.2 * WATCHED_S))
    assert len(found) == 3
    assert found == pytest.approx([rate_hz] * 3, rel=0.02)


def test_frames_that_count_by_the_clock_are_too_fast_but_not_too_slow():
    fast = [(int(k / 3), k / 300.0) for k in range(3000)]
    assert told(fast) == pytest.approx([300.0] * 3, rel=0.02)
    assert told(frames(33.3, 20.0, step=3)) == []  # lost ones


def test_a_pause_and_a_burst_are_no_rate():
    pairs = [(k, (k + (100 if k > 300 else 0)) / 100.0) for k in range(1000)]
    held = [(number, 5.2 if 5.0 < at < 5.2 else at) for number, at in frames(100.0, 10.0)]
    assert told(held) == []
    assert told(pairs) == []
