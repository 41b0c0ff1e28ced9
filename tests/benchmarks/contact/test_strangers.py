"""Rows of the moment at L5/S1: error per kg and share inside the interval, both ways."""

import numpy as np
import pytest

from benchmarks.contact.strangers import lumbosacral_rows
from tests.io.reconstructions import with_trunk

REFERENCE = np.linspace(-40.0, 200.0, 12)


def off_by(down, up):
    """A result whose moments at L5/S1 are the reference's, off by constants."""
    moments = np.zeros((12, 2, 2, 3))
    moments[:, 0, 1, 0], moments[:, 1, 1, 0] = REFERENCE + down, REFERENCE + up
    return with_trunk(trunk_moments=moments, trunk_moments_sd=np.full(moments.shape, 5.0))


def test_both_ways_are_judged_by_the_bound():
    found = off_by(7.05, 21.15)
    rows = {row.name: row for row in lumbosacral_rows("lift", found, REFERENCE, 0.25)}
    down, up = (rows[f"lift: moment at L5/S1, {way}, RMS"] for way in ("top-down", "bottom-up"))
    assert (down.value, up.value) == (pytest.approx(0.1), pytest.approx(0.3))
    assert down.passed and not up.passed
    inside = [
        rows[f"lift: moment at L5/S1, {way}, errors within their 95 % intervals"].value
        for way in ("top-down", "bottom-up")
    ]
    assert inside == [100.0, 0.0]


def test_without_a_bound_rows_are_information():
    rows = lumbosacral_rows("lift", off_by(0.0, 7.05), REFERENCE[:8], None)
    assert [row.value for row in rows] == [pytest.approx(0.0), pytest.approx(0.1)]
    assert len(rows) == 2
