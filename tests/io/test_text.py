"""What all readers of text files share."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.text import (
    TextFile,
    check_order,
    compare_count,
    compare_rate,
    csv_rows,
    decoded,
    even_rate,
    number,
    numbers,
    read_text,
)


@pytest.mark.parametrize(("content", "whole"), [("a\nb\n", True), ("a\r\nb\r\n", True), ("a\nb", False)])
def test_lines_and_whether_the_last_is_whole(tmp_path, content, whole):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbf" + content.encode())
    file = read_text(path, "a text")
    assert (file.lines, file.whole) == (["a", "b"], whole)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_texts_of_other_encodings_are_decoded(encoding):
    assert decoded("Knöchel µ".encode(encoding)) == "Knöchel µ"
    assert decoded(b"\xfe\xff" + "Knöchel".encode("utf-16-be")) == "Knöchel"


def test_lines_keep_their_numbers_without_comments(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("# made\na\n  # by\nb\n")
    file = read_text(path, "a text").without_comments()
    assert file.lines == ["a", "b"] and [file.line(k) for k in (0, 1)] == [2, 4]
    assert read_text(path, "a text").line(1) == 2


def test_commas_are_decimal_in_a_row_without_points(tmp_path):
    assert numbers(["1", "-2,5", ",5", "1,5e-3"], tmp_path, 1) == [1.0, -2.5, 0.5, 0.0015]
    assert number("100,5") == 100.5 and number("1,234,5") is number("1.234,5") is None
    for cells in (["1,234", "0.5"], ["1,234,567"], ["1,5", "x"]):
        with pytest.raises(FileFormatError, match="line 3: not a number"):
            numbers(cells, tmp_path, 3)


def test_zeros_without_a_comma_are_no_evidence_of_thousands(tmp_path):
    cells = ["1,005", "0", "0", "0", "", "0"]
    np.testing.assert_array_equal(numbers(cells, tmp_path, 4), [1.005, 0, 0, 0, np.nan, 0])


@pytest.mark.parametrize("cells", [["1", "0", "1,234", "567", "-8,901"], ["1", "0", "999", "", "1,234"]])
def test_commas_of_thousands_in_a_row_of_whole_numbers_are_no_decimals(tmp_path, cells):
    with pytest.raises(FileFormatError, match="line 4: '1,234' beside whole numbers may be a thousand"):
        numbers(cells, tmp_path, 4)


@pytest.mark.parametrize(
    "cells", [["101", "1", "123,456", "789,012"], ["1", "2", "3", "0,123"], ["1", "2", "3", "1,23"]]
)
def test_commas_that_can_only_be_decimal_stay_decimal(tmp_path, cells):
    assert numbers(cells, tmp_path, 4) == [float(cell.replace(",", ".")) for cell in cells]


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileFormatError, match="no such file; name a TRC file"):
        read_text(tmp_path / "none", "a TRC file")


def test_numbers(tmp_path):
    np.testing.assert_array_equal(
        numbers(["1", " ", "-2e3", "nan"], tmp_path, 7), [1.0, np.nan, -2000.0, np.nan]
    )
    with pytest.raises(FileFormatError, match="line 7: not a number"):
        numbers(["1", "x"], tmp_path, 7)
    assert [number(word) for word in ("3", "x", "", "inf")] == [3.0, None, None, None]


def test_counts_are_compared(tmp_path):
    whole, broken = (TextFile(tmp_path, [], ended) for ended in (True, False))
    assert compare_count(whole, None, 3, "rows") == compare_count(whole, 3, 3, "rows") == []
    assert compare_count(whole, 5, 3, "rows") == ["the header counts 5 rows, 3 are there"]
    assert compare_count(broken, 2, 3, "rows") == ["the header counts 2 rows, 3 are there"]
    with pytest.raises(FileFormatError, match="cut short: the header promises 5 rows, 3 are there"):
        compare_count(broken, 5, 3, "rows")


def test_rates_are_compared():
    times = np.arange(5) / 50.0
    assert compare_rate(50.0, times) == compare_rate(50.0, times[:1]) == []
    assert "60 Hz" in compare_rate(60.0, times)[0]
    assert "does not increase" in compare_rate(50.0, 0.0 * times)[0]


def test_even_times(tmp_path):
    assert even_rate(tmp_path, np.round(np.arange(100) / 600.0, 4)) == pytest.approx(600.0, abs=0.5)
    for times, reason in (
        (np.zeros(4), "increase"),
        (np.array([0.0, 1.0, 5.0]), "evenly"),
        (np.ones(1), "increase"),
    ):
        with pytest.raises(FileFormatError, match=reason):
            even_rate(tmp_path, times)


def test_cells_of_csv_lines_and_a_quotation_mark_without_end(tmp_path):
    assert list(csv_rows(['a,"b;c"', "", "1;2"], tmp_path, delimiter=";")) == [['a,"b', 'c"'], [], ["1", "2"]]
    lines = ["a,b", '"' + 70_000 * "x", 70_000 * "y"]
    with pytest.raises(FileFormatError, match=r"line 12: damaged .*field larger") as caught:
        list(csv_rows(lines, tmp_path / "a.csv", 10))
    assert caught.value.line == 12


def test_rows_in_their_order_are_left_and_others_refused_with_their_line(tmp_path):
    path, told = tmp_path / "a.csv", r"the time goes from .*rows are missing or out of order"
    for counted in ([], [3.0], [0.0, 0.01, 0.0201, 0.0299], [5.0, 6.0, 7.0]):
        check_order(path, np.array(counted), "the time")
    for counted, row in (
        ([0, 1, 3, 4], 2),
        ([0, 1, 1, 2, 3], 2),
        ([3, 2, 1], 1),
        ([0, 1, 2, np.inf, np.inf], 3),
    ):
        with pytest.raises(FileFormatError, match=told) as caught:
            check_order(path, np.array(counted, dtype=float), "the time", 10)
        assert caught.value.line == 10 + row
    with pytest.raises(FileFormatError, match="goes from 0 to nan"):
        check_order(path, np.array([0.0, np.nan, 2.0]), "the time")
