"""Comparison with another program's curves: zero, and a sign that shows."""

import numpy as np
import pytest

from benchmarks.clinic.convention import Compared

THEIRS = np.array([0.0, 10.0, 20.0, np.nan, 10.0])


def test_zero_and_sign():
    same = Compared.of(THEIRS + 2.0, THEIRS)
    assert (same.offset, same.rms, same.correlation) == pytest.approx((2.0, 0.0, 1.0))
    turned = Compared.of(20.0 - THEIRS, THEIRS)
    assert turned.correlation == pytest.approx(-1.0) and turned.sign_shows(3.0), "a reversed curve is judged"
    assert not turned.sign_shows(8.0), "a curve that hardly moves is not"
    noise = Compared.of(np.array([1.0, -1.0, 1.0, 0.0, -1.0]), THEIRS)
    assert not noise.sign_shows(3.0)
    assert np.isnan(Compared.of(np.full(5, np.nan), THEIRS).offset)
