"""Frames that carry no number: none is lost but those that stamps prove, at any jitter; no clock is asked."""

import numpy as np
import pytest

from mbkf.stream.lsl.stamp_numbering import CONFIRMED, SETTLED, StampedItems, StampNumbering

RATE_HZ = 100.0
FRAMES = 600


def numbers_of(stamps, arrivals=None, **options):
    """All numbers, and how many frames waited at most after the start."""
    found, waited = [], 0
    numbering = StampNumbering(options.pop("rate_hz", RATE_HZ), **options)
    for stamp, arrival in zip(stamps, stamps if arrivals is None else arrivals, strict=True):
        found += numbering.put(float(stamp), float(arrival))
        waited = max(waited, numbering.waiting if len(found) else 0)
    return np.array(found + numbering.flush()), waited, numbering


@pytest.mark.parametrize(
    "jitter",
    [
        lambda rng: np.zeros(FRAMES),
        lambda rng: rng.normal(0.0, 0.001, FRAMES),
        lambda rng: rng.uniform(0.0, 0.02, FRAMES),
        lambda rng: rng.exponential(0.005, FRAMES),
        lambda rng: 0.1 * (rng.uniform(size=FRAMES) < 0.02),
        lambda rng: 0.01 * np.floor(rng.uniform(0.0, 1.6, FRAMES)),
    ],
    ids=["exact", "1 ms", "uniform 20 ms", "queue", "single frames 100 ms late", "coarse clock"],
)
@pytest.mark.parametrize("seed", range(5))
def test_jitter_loses_no_frame(jitter, seed):
    stamps = 7.0 + np.arange(FRAMES) / RATE_HZ + jitter(np.random.default_rng(seed))
    found, waited, _ = numbers_of(stamps)
    np.testing.assert_array_equal(found, np.arange(FRAMES))
    assert waited <= CONFIRMED


@pytest.mark.parametrize("missing", [1, 2, 50, 500])
@pytest.mark.parametrize("seed", range(3))
def test_a_gap_that_stamps_prove_is_counted_exactly(missing, seed):
    true = np.arange(FRAMES) + missing * (np.arange(FRAMES) >= 300)
    stamps = true / RATE_HZ + np.random.default_rng(seed).normal(0.0, 0.0005, FRAMES)
    found, waited, _ = numbers_of(stamps)
    np.testing.assert_array_equal(found, true)
    assert waited == CONFIRMED


def test_gaps_at_random_are_counted_exactly():
    true = np.flatnonzero(np.random.default_rng(0).uniform(size=FRAMES) > 0.33)
    found, _, _ = numbers_of(true / RATE_HZ)
    np.testing.assert_array_equal(found, true - true[0])


@pytest.mark.parametrize("seed", range(5))
def test_a_long_gap_beside_jitter_is_as_long_as_the_jitter_allows(seed):
    true = np.arange(FRAMES) + 50 * (np.arange(FRAMES) >= 300)
    found, _, _ = numbers_of(true / RATE_HZ + np.random.default_rng(seed).uniform(0.0, 0.03, FRAMES))
    np.testing.assert_array_equal(found[:300], true[:300])
    assert np.abs(found - true).max() <= 3


def test_a_sender_that_pauses_and_catches_up_has_lost_nothing():
    """Stamps of the sending: nothing for 0.3 s, then 30 frames at once."""
    stamps = np.arange(FRAMES) / RATE_HZ
    stamps[300:330] = 3.3 + 1e-4 * np.arange(30)
    found, _, _ = numbers_of(stamps)
    np.testing.assert_array_equal(found, np.arange(FRAMES))


@pytest.mark.parametrize("jump_s", [-1.0, -3600.0, 3600.0])
def test_stamps_of_another_clock_lose_nothing(jump_s):
    arrivals = np.arange(FRAMES) / RATE_HZ
    found, _, numbering = numbers_of(arrivals + jump_s * (np.arange(FRAMES) >= 300), arrivals)
    np.testing.assert_array_equal(found, np.arange(FRAMES))
    assert numbering.jumps == 1


def test_time_without_frames_counts_where_the_clock_changed_meanwhile():
    true = np.arange(FRAMES) + 80 * (np.arange(FRAMES) >= 300)
    arrivals = true / RATE_HZ
    found, _, _ = numbers_of(arrivals - 1000.0 * (true >= 380), arrivals)
    np.testing.assert_array_equal(found, true)


def test_stamps_that_are_not_numbers_tell_nothing():
    stamps = np.arange(FRAMES) / RATE_HZ
    arrivals = stamps.copy()
    stamps[5:8] = stamps[300:350] = np.nan
    found, _, _ = numbers_of(stamps, arrivals)
    np.testing.assert_array_equal(found, np.arange(FRAMES))


@pytest.mark.parametrize("rate_hz", [80.0, 99.9, 100.02, 300.0])
def test_a_sender_of_another_rate_loses_nothing(rate_hz):
    found, _, _ = numbers_of(np.arange(FRAMES) / rate_hz)
    np.testing.assert_array_equal(found, np.arange(FRAMES))


def test_half_the_rate_leaves_out_every_second_number():
    found, _, _ = numbers_of(np.arange(FRAMES) / 50.0)
    np.testing.assert_array_equal(found, 2 * np.arange(FRAMES))


@pytest.mark.parametrize("missing", [0, 300])
def test_samples_that_come_in_groups_late_by_less_than_a_group_lose_none(missing):
    true = np.arange(4000) + missing * (np.arange(4000) >= 2000)
    sent = true[9::10] / 1000.0 + np.random.default_rng(1).uniform(0.0, 0.004, 400)
    stamps = np.repeat(sent, 10) - np.tile(np.arange(9, -1, -1) / 1000.0, 400)
    found, _, _ = numbers_of(stamps, rate_hz=1000.0, group=10, origin_s=0.002)
    apart = found - true
    assert np.ptp(apart[:2000]) == 0 and np.ptp(apart[2000:]) == 0
    assert abs(apart[-1] - apart[0]) <= 3 * (missing > 0)


def test_the_line_of_stamps_is_found_from_the_first_frames():
    stamps = np.arange(FRAMES) / RATE_HZ
    stamps[0] += 0.004
    _, _, numbering = numbers_of(stamps[:SETTLED])
    assert numbering.origin_s == pytest.approx(0.0, abs=1e-9)


def test_frames_are_counted_higher_on_demand():
    numbering = StampNumbering(RATE_HZ)
    for n in range(20):
        numbering.put(n / RATE_HZ, 0.0)
    numbering.shift(7)
    assert numbering.put(20 / RATE_HZ, 0.0) == [27]
    assert numbering.put(23 / RATE_HZ, 0.0) == [] and numbering.flush() == [30]


def test_items_keep_their_order():
    items = StampedItems(StampNumbering(RATE_HZ))
    found = [one for n in (0, 1, 2, 5, 6) for one in items.put(f"frame {n}", n / RATE_HZ, n / RATE_HZ)]
    assert found == [] and items.flush() == [(n, f"frame {n}") for n in (0, 1, 2, 5, 6)]
