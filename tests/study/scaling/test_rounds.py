"""Trials are looked at one of each kind of name at a time, in an order that follows from the names alone."""

import random

from hypothesis import given
from hypothesis import strategies as st

from mbkf.study.scaling.rounds import MOST_TRIALS, rounds


def test_each_kind_of_name_has_its_turn_and_numbers_are_counted():
    names = ["walk10", "walk2", "squat_01", "Walk 1", "run-3"]
    assert rounds(names) == [["run-3", "squat_01", "Walk 1"], ["walk2"], ["walk10"]]


@given(st.sets(st.text("abW_ 123", min_size=1, max_size=4), max_size=20), st.randoms())
def test_the_order_of_the_names_does_not_matter_and_each_comes_once(names, chance):
    shuffled = sorted(names)
    chance.shuffle(shuffled)
    found = rounds(shuffled)
    flat = [name for one in found for name in one]
    assert found == rounds(sorted(names)) and len(set(flat)) == len(flat) == min(len(names), MOST_TRIALS)
    assert set(flat) <= names and all(found)


def test_no_more_than_the_most_are_looked_at():
    names = [f"trial{k}" for k in range(3 * MOST_TRIALS)]
    random.Random(1).shuffle(names)
    assert rounds(names) == [[f"trial{k}"] for k in range(MOST_TRIALS)]
