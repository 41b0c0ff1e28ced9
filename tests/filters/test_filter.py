"""Readings of a frame as one whole: information, its product with vectors, and the innovations' vector."""

import numpy as np
from mbkf.filters.dynamic_records import FrameReadings

from mbkf.numerics.kalman import information

N, n = 9, 4
RNG = np.random.default_rng(2)
H, Y, SD = RNG.normal(size=(6, n)), RNG.normal(size=6), RNG.uniform(0.5, 2.0, 6)
ROWS, VALUES = RNG.normal(size=(3, N)), RNG.normal(size=3)
MARKERS = information(Y, H, SD)
READINGS = FrameReadings(MARKERS, MARKERS.matrix, MARKERS.vector, ROWS, VALUES, 3)


def stacked():
    """All readings as whitened rows on the whole state, and their innovations."""
    markers = np.hstack([H / SD[:, None], np.zeros((6, N - n))])
    return np.vstack([markers, ROWS]), np.concatenate([Y / SD, VALUES])


def test_the_whole_is_what_all_rows_say():
    rows, values = stacked()
    np.testing.assert_allclose(READINGS.whole_matrix, rows.T @ rows, atol=1e-12)
    np.testing.assert_allclose(READINGS.whole_vector, values @ rows, atol=1e-12)


def test_applying_is_multiplying():
    x = RNG.normal(size=N)
    np.testing.assert_allclose(READINGS.apply(x), READINGS.whole_matrix @ x, atol=1e-12)
