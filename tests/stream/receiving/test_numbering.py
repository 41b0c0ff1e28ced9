"""Numbers go up whatever the source counts, and what is missing is told."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.stream.receiving.numbering import BACK_FRAMES, LATE_S, Numbering
from mbkf.stream.source import UNCOUNTED

RATE_HZ = 100.0


def placed(pairs):
    numbering = Numbering(RATE_HZ)
    return [numbering.place(number, arrival_s) for number, arrival_s in pairs]


def in_time(numbers, first_s=0.0):
    return [(n, first_s + k / RATE_HZ) for k, n in enumerate(numbers)]


def test_a_regular_count_is_kept():
    found = placed(in_time(range(37, 60)))
    assert [place.number for place in found] == list(range(37, 60))
    assert not any(place.lost or place.reset for place in found)


@given(st.sets(st.integers(1, 98)))
def test_lost_frames_are_counted(dropped):
    kept = [n for n in range(100) if n not in dropped]
    found = placed([(n, n / RATE_HZ) for n in kept])
    assert [place.number for place in found] == kept
    assert sum(place.lost for place in found) == len(dropped)


def test_late_and_repeated_frames_have_no_place():
    found = placed(in_time([0, 1, 3, 2, 4, 4, 5]))
    assert [place.number for place in found] == [0, 1, 3, None, 4, None, 5]
    assert sum(place.lost for place in found) == 1


def test_a_count_set_far_back_goes_on_by_the_time_that_passed():
    found = placed([*in_time(range(1000, 1010)), (0, 0.5), (1, 0.51)])
    assert [place.number for place in found[-2:]] == [1050, 1051]
    assert (found[-2].reset, found[-2].backwards, found[-2].lost) == (True, True, 40)
    assert not found[-1].reset


def test_a_count_set_a_little_back_is_noticed_after_a_few_frames():
    found = placed(in_time([*range(50), *range(40, 60)]))
    numbers = [place.number for place in found]
    assert numbers[50 : 50 + BACK_FRAMES - 1] == [None] * (BACK_FRAMES - 1)
    assert numbers[-1] == 69
    assert sum(place.reset for place in found) == 1


def test_a_leap_that_time_does_not_explain_is_not_believed():
    found = placed([*in_time(range(10)), (2**31, 0.1), (2**31 + 1, 0.11)])
    assert [place.number for place in found[-2:]] == [10, 11]
    assert found[-2].reset
    assert not found[-2].backwards


@pytest.mark.parametrize("strange", [0, 10**6])
def test_a_single_wrong_count_leaves_the_others_as_they_are(strange):
    found = placed(in_time([*range(60), strange, *range(61, 80)]))
    assert [place.number for place in found] == list(range(80))
    assert sum(place.lost for place in found) == 0


def test_a_count_that_stands_still_is_replaced_by_time():
    found = placed(in_time([*range(60), *(100 * [60])]))
    kept = [place.number for place in found if place.number is not None]
    assert kept[60] == 60
    assert kept[61:] == list(range(kept[61], 160))
    assert len(kept) == 160 - round(LATE_S * RATE_HZ)


def test_a_leap_that_time_explains_is_a_loss():
    found = placed([*in_time(range(10)), (510, 5.1)])
    assert (found[-1].number, found[-1].lost, found[-1].reset) == (510, 500, False)


@pytest.mark.parametrize("strange", [2**60, -(2**60), UNCOUNTED])
def test_a_count_that_cannot_be_one_is_passed_over(strange):
    found = placed(in_time([*range(10), strange, *range(11, 20), strange]))
    assert [place.number for place in found] == list(range(21))[: len(found)]
    assert [place.reset for place in found] == [n in (10, 20) for n in range(len(found))]
    assert not any(place.lost for place in found)


def test_without_any_count_time_numbers_the_frames():
    found = placed([(UNCOUNTED, 0.01 * k + 0.003 * (k % 2)) for k in range(100)])
    assert [place.number for place in found] == list(range(100))
    then = placed([(UNCOUNTED, 0.0), (500, 0.01), (501, 0.02)])
    assert [place.number for place in then] == [0, 1, 2]


@given(st.lists(st.tuples(st.integers(-(2**62), 2**62), st.floats(0.0, 0.5)), max_size=60))
def test_numbers_always_rise(steps):
    arrival_s, pairs = 0.0, []
    for number, passed_s in steps:
        arrival_s += passed_s
        pairs.append((number, arrival_s))
    numbers = [place.number for place in placed(pairs) if place.number is not None]
    assert all(b > a for a, b in pairwise(numbers))
    # Never faster than time allows, give or take the slack.
    if numbers:
        assert numbers[-1] - numbers[0] <= arrival_s * RATE_HZ + (len(numbers) + 1) * (RATE_HZ + 1)
