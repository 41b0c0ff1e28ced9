"""Layouts: slices without gaps in order, those that blocks add at the end, and names that occur once."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.model.layout import ExtraState, Layout, parted

BIAS = ExtraState("bias", np.array([1.0, 2.0, 3.0]), np.full(3, 0.1), np.full(3, 0.5))
LENGTH = ExtraState("length", np.array([4.0]), np.array([0.2]), np.zeros(1))
PLAIN = Layout.of(5, q=5, v=5, a=5, wrench=12)


def test_parts_follow_each_other_without_gaps():
    assert (PLAIN.q, PLAIN.v, PLAIN.a, PLAIN.wrench) == (
        slice(0, 5),
        slice(5, 10),
        slice(10, 15),
        slice(15, 27),
    )
    assert (PLAIN.size, PLAIN.nv) == (27, 5)
    assert PLAIN["wrench"] == PLAIN.wrench and "wrench" in PLAIN and "bias" not in PLAIN


def test_added_states_come_last_in_their_order():
    whole = PLAIN.with_extras([BIAS]).with_extras([LENGTH])
    assert whole == PLAIN.with_extras([BIAS, LENGTH])
    assert (whole["bias"], whole["length"], whole.size) == (slice(27, 30), slice(30, 31), 31)
    assert (whole.extra_index("bias"), whole.extra_index("length")) == (slice(0, 3), slice(3, 4))
    assert PLAIN.size == 27


def test_start_and_random_walk_are_those_of_the_added_states():
    mean, sd = PLAIN.with_extras([BIAS, LENGTH]).start()
    np.testing.assert_array_equal(mean, [1.0, 2.0, 3.0, 4.0])
    np.testing.assert_array_equal(sd, [0.1, 0.1, 0.1, 0.2])
    walk = PLAIN.with_extras([BIAS, LENGTH]).walk_variance(0.01)
    np.testing.assert_allclose(walk, [0.0025, 0.0025, 0.0025, 0.0])


def test_without_added_states_there_is_nothing_to_start():
    assert [len(part) for part in (*PLAIN.start(), PLAIN.walk_variance(0.1))] == [0, 0, 0]


def test_names_occur_once_and_unknown_ones_are_refused():
    with pytest.raises(InvalidInput, match="'bias'"):
        PLAIN.with_extras([BIAS, BIAS])
    with pytest.raises(InvalidInput, match="'wrench'"):
        PLAIN.with_extras([ExtraState("wrench", np.zeros(1), np.zeros(1), np.zeros(1))])
    with pytest.raises(UnknownName):
        PLAIN["bias"]


def test_a_tangent_vector_falls_into_parts_as_long_as_their_patterns():
    vector = np.arange(6.0)
    first, middle, last = parted(vector, np.zeros(2), np.zeros(3), np.zeros(1))
    np.testing.assert_array_equal(np.concatenate([first, middle, last]), vector)
    assert (len(first), len(middle), len(last)) == (2, 3, 1)
