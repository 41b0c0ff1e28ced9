"""The running median is numpy's of the last numbers and the zeros, whatever comes and goes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.numerics.running_median import RunningMedian

numbers = st.lists(st.one_of(st.floats(-9.0, 9.0), st.just(np.nan), st.just(0.5)), max_size=30)


@given(numbers, st.integers(1, 12), st.integers(1, 5))
def test_it_is_the_median_of_the_last_numbers_and_zeros(values, most, zeros):
    found = RunningMedian()
    for value in values:
        found = found.followed(value, most)
    last = values[-most:]
    known = [value for value in last if not np.isnan(value)]
    assert found.median(zeros) == pytest.approx(np.median(known + [0.0] * zeros), abs=1e-15)
    np.testing.assert_array_equal(found.latest, last)
    if known:
        assert found.median() == pytest.approx(np.median(known), abs=1e-15)


def test_a_number_more_leaves_the_one_before_as_it_was():
    before = RunningMedian().followed(1.0, 3)
    before.followed(2.0, 3)
    assert before == ((1.0,), [1.0])


def test_of_nothing_there_is_none():
    with pytest.raises(IndexError):
        RunningMedian().median()
