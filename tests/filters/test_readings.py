"""What blocks say together: sums of information on states of different length, rows in order, what NIS counts."""

import numpy as np

from mbkf.filters.readings import summed
from mbkf.numerics.kalman import Information, information
from mbkf.sensors.block import Rows
from mbkf.sensors.layout import Layout
from tests.motions import assert_near

LAYOUT = Layout.of(2, q=2, v=2, a=1)
RNG = np.random.default_rng(0)


class Speaker:
    """Stands for a block: an instrument, or a prior."""

    def __init__(self, prior):
        self.prior = prior


def dense(n, m=4):
    """Readings on the first n components, as information and as dense H, y."""
    H, y = RNG.normal(size=(m, n)), RNG.normal(size=m)
    return information(y, H, np.ones(m)), np.pad(H, ((0, 0), (0, LAYOUT.size - n))), y


def test_everything_together_is_the_stacked_regression():
    short, H1, y1 = dense(2)
    long, H2, y2 = dense(4)
    rows = Rows(RNG.normal(size=(3, 2)), RNG.normal(size=3), first=3, readings=2)
    H3 = np.zeros((3, LAYOUT.size))
    H3[:, 3:5] = rows.jacobian
    found = summed(
        [Speaker(False), Speaker(True), Speaker(False), Speaker(True)], [short, long, rows, None], LAYOUT
    )
    H, y = np.vstack([H1, H2, H3]), np.concatenate([y1, y2, rows.innovation])
    assert_near(found.whole_matrix, H.T @ H, 1e-12)
    assert_near(found.whole_vector, H.T @ y, 1e-12)
    x = RNG.normal(size=LAYOUT.size)
    assert_near(found.apply(x), H.T @ (H @ x), 1e-12)


def test_priors_count_in_no_nis():
    known, _, _ = dense(2)
    believed, _, _ = dense(2)
    rows = Rows(np.ones((3, 5)), np.arange(3.0), readings=2)
    pulls = Rows(np.ones((1, 5)), np.ones(1))
    found = summed([Speaker(False), Speaker(True), Speaker(False)], [known, believed, [pulls, rows]], LAYOUT)
    assert found.instruments.readings == known.readings
    np.testing.assert_array_equal(found.instruments.matrix, known.matrix)
    assert_near(found.matrix, known.matrix + believed.matrix, 1e-15)
    counted, values = found.counted
    assert counted.shape == (2, 5)
    np.testing.assert_array_equal(values, [0.0, 1.0])


def test_instruments_of_different_length_add_up():
    first, H1, y1 = dense(2)
    second, H2, y2 = dense(4)
    found = summed([Speaker(False), Speaker(False)], [first, second], LAYOUT).instruments
    H, y = np.vstack([H1, H2])[:, :4], np.concatenate([y1, y2])
    assert_near(found.matrix, H.T @ H, 1e-12)
    assert_near(found.vector, H.T @ y, 1e-12)
    assert (found.readings, found.innovation) == (8, float(y1 @ y1) + float(y2 @ y2))


def test_silence_says_nothing():
    found = summed([Speaker(False), Speaker(True)], [None, []], LAYOUT)
    assert not found.whole_matrix.any() and not found.whole_vector.any()
    assert isinstance(found.instruments, Information) and found.instruments.readings == 0
    assert found.rows.shape == (0, LAYOUT.size)
