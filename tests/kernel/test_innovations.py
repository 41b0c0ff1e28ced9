"""The kernel judges innovations as numpy does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import READING_KINDS
from mbkf.filters.innovations import InnovationSpreads
from mbkf.kernel.loading import library
from mbkf.numerics.running_spread import RunningSpread
from mbkf.sensors.block import Block, Channels, Rows

needs_kernel = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")


class Reader(Block):
    """A block of one kind whose channels have an expected spread, or not."""

    def __init__(self, kind, expected):
        self.kind, self._expected, self.quantities = kind, expected, 3

    def expected_spread(self):
        return self._expected

    def linearise(self, at, decision):
        return None


@needs_kernel
@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6))
def test_they_are_judged_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    expected = rng.uniform(0.5, 2.0, 7)
    blocks = [
        Reader(READING_KINDS[0], expected),
        Reader(READING_KINDS[2], None),
        Reader("plates", expected[:2]),
    ]
    spreads = InnovationSpreads(blocks, 0.01)
    before = RunningSpread(np.exp(rng.normal(0.0, 3.0, 12)), rng.choice([0.0, 1.0, 2.0, 80.0], 12))
    read = Channels(rng.chisquare(3, 12), rng.choice([0.0, 1.0, 3.0], 12))
    found, after = spreads.judged(before, read)
    for one, other in zip(found, spreads.innovations(before, read), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13)
    for one, other in zip(after, spreads.after(before, read), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13)


@needs_kernel
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_whitened_rows_are_read_as_by_the_reference(seed):
    """Between the channels of another block; a list of rows is read by the reference."""
    rng = np.random.default_rng(seed)
    blocks = [Reader("law", np.ones(2)), Reader("plates", None), Reader("markers", np.ones(1))]
    y = rng.normal(size=rng.integers(0, 16))
    rows = Rows(np.zeros((len(y), 4)), y, 0, int(rng.integers(0, len(y) + 1)))
    spreads = InnovationSpreads(blocks, 0.01)
    found = spreads.read([None] * 3, [None, rows, rows])
    for one, other in zip(found, spreads.read([None] * 3, [None, [rows], [rows]]), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13)
    assert found.readings.tolist()[:2] == [0.0, 0.0]
    assert found.readings[2:5].sum() == found.readings[5:].sum() == rows.readings
