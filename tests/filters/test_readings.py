"""Readings of a frame as one whole: information, its product with vectors, and the rows that count."""

from types import SimpleNamespace

import numpy as np

from mbkf.filters.readings import Readings, summed
from mbkf.model.layout import Layout
from mbkf.numerics.kalman import information
from mbkf.sensors.block import Rows
from tests.motions import assert_near

N, n = 9, 4
RNG = np.random.default_rng(2)
H, Y, SD = RNG.normal(size=(6, n)), RNG.normal(size=6), RNG.uniform(0.5, 2.0, 6)
PARTS = (
    Rows(RNG.normal(size=(2, N)), RNG.normal(size=2), readings=2),
    Rows(RNG.normal(size=(3, 4)), RNG.normal(size=3), first=5, readings=1),
)
ROWS = np.vstack([PARTS[0].jacobian, np.pad(PARTS[1].jacobian, ((0, 0), (5, 0)))])
VALUES = np.concatenate([part.innovation for part in PARTS])
MARKERS = information(Y, H, SD)
READINGS = Readings(MARKERS, MARKERS.matrix, MARKERS.vector, ROWS, VALUES, (PARTS,))


def stacked():
    """All readings as whitened rows on the whole state, and their innovations."""
    markers = np.hstack([H / SD[:, None], np.zeros((6, N - n))])
    return np.vstack([markers, ROWS]), np.concatenate([Y / SD, VALUES])


def test_the_whole_is_what_all_rows_say():
    rows, values = stacked()
    np.testing.assert_allclose(READINGS.whole_matrix, rows.T @ rows, atol=1e-12)
    np.testing.assert_allclose(READINGS.whole_vector, values @ rows, atol=1e-12)


def test_the_first_rows_of_each_part_are_the_readings_that_count():
    rows, values = READINGS.counted
    np.testing.assert_array_equal(rows, ROWS[[0, 1, 2]])
    np.testing.assert_array_equal(values, VALUES[[0, 1, 2]])


def test_a_vector_that_its_block_gave_stands_for_the_product():
    rows = Rows(
        np.array([[0.5, 0.0], [0.0, 0.25]]), np.array([2.0, 4.0]), first=2, vector=np.array([1.0, 1.0])
    )
    plain = rows._replace(vector=None)
    given, formed = (
        summed([SimpleNamespace(prior=True)], [one], Layout.of(2, q=2, v=2)) for one in (rows, plain)
    )
    assert_near(given.whole_vector, formed.whole_vector, 1e-15)
    np.testing.assert_array_equal(given.whole_matrix, formed.whole_matrix)
