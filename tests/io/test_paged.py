"""Arrays whose rows lie in a file."""

import numpy as np
import pytest

from mbkf.io.paged import PagedArray


@pytest.fixture
def paged(tmp_path):
    """23 rows of 2 × 3 numbers in pages of 5, of which two are in memory."""
    return PagedArray.unknown(tmp_path / "rows", (23, 2, 3), 5, pages=2)


def test_what_is_written_anywhere_is_read_back(paged):
    rng = np.random.default_rng(0)
    wanted = np.full((23, 2, 3), np.nan)
    for _ in range(60):
        first = int(rng.integers(0, 23))
        after = min(first + int(rng.integers(1, 9)), 23)
        values = rng.normal(size=(after - first, 2, 3))
        wanted[first:after] = paged[first:after] = values
        t = int(rng.integers(0, 23))
        wanted[t] = paged[t] = rng.normal(size=(2, 3))
        np.testing.assert_array_equal(paged[3:20], wanted[3:20])
    paged.close_writing()
    np.testing.assert_array_equal(paged[0:23], wanted)
    np.testing.assert_array_equal(paged[-1], wanted[-1])
    assert len(paged) == 23 and paged.shape == wanted.shape
    assert paged[7:7].shape == (0, 2, 3) and paged[20:99].shape == (3, 2, 3)


def test_a_row_is_a_view_while_it_is_written_and_survives_its_page(paged):
    row = paged[4:5]
    row[:] = 7.0
    for t in (9, 14, 19, 22):
        assert np.isnan(paged[t]).all()
    np.testing.assert_array_equal(paged[4], np.full((2, 3), 7.0))


def test_later_changes_are_not_kept(paged):
    paged[2] = np.ones((2, 3))
    paged.close_writing()
    paged[2][:] = 5.0
    for t in (9, 14, 19):
        paged[t]
    np.testing.assert_array_equal(paged[2], np.ones((2, 3)))


def test_columns_are_chosen_when_rows_are_read(paged):
    values = np.arange(23 * 6.0).reshape(23, 2, 3)
    paged[0:23] = values
    turned = paged[:, [1, 0]]
    np.testing.assert_array_equal(turned[4:13], values[4:13][:, [1, 0]])
    np.testing.assert_array_equal(turned[17], values[17][[1, 0]])
    assert len(turned) == 23


def test_records_have_blanks_of_their_own(tmp_path):
    dtype = np.dtype([("number", "<i8"), ("q", "<f8", 4)])

    def blank(first, after):
        rows = np.zeros(after - first, dtype)
        rows["number"] = np.arange(first, after)
        return rows

    paged = PagedArray(tmp_path / "rows", blank, 10, 3, pages=1)
    paged[4:5]["q"] = 1.5
    assert paged[0:10]["number"].tolist() == list(range(10))
    assert paged[0:10]["q"][:, 2].tolist() == [0.0] * 4 + [1.5] + [0.0] * 5


def test_numbers_beyond_the_end_and_steps_are_refused(paged):
    with pytest.raises(IndexError):
        paged[23]
    with pytest.raises(IndexError, match="every 2"):
        paged[0:10:2]
