"""A log keeps every whole row that was written, after any kind of end."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.frame_log import FrameLogWriter, read_frame_log

DTYPE = np.dtype([("number", "<i8"), ("flag", "?"), ("q", "<f8", (2, 3)), ("none", "<f8", (0, 6))])


def rows(count, first=0):
    made = np.zeros(count, dtype=DTYPE)
    made["number"] = first + np.arange(count)
    made["flag"] = made["number"] % 2 == 0
    made["q"] = np.random.default_rng(first).normal(size=(count, 2, 3))
    made["q"][:, 0, 0] = np.nan
    return made


def test_rows_and_header_come_back(tmp_path):
    with FrameLogWriter(
        tmp_path / "x.log", DTYPE, {"rate": 100.0, "names": ["Ä"], "far": float("inf")}
    ) as log:
        log.append(rows(3))
        log.append(rows(2, 3))
        assert log.rows == 5
        header, found = read_frame_log(log.path)  # also while it is written
    assert header == {"rate": 100.0, "names": ["Ä"], "far": float("inf")}
    assert found.dtype == DTYPE
    np.testing.assert_array_equal(found["number"], np.arange(5))
    np.testing.assert_array_equal(found["q"], np.concatenate([rows(3)["q"], rows(2, 3)["q"]]))


@given(cut=st.integers(0, 3 * DTYPE.itemsize))
def test_a_row_that_was_cut_off_is_ignored(tmp_path_factory, cut):
    path = tmp_path_factory.mktemp("log") / "x.log"
    with FrameLogWriter(path, DTYPE, {}) as log:
        log.append(rows(3))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - cut])
    _, found = read_frame_log(path)
    assert found["number"].tolist() == list(range((3 * DTYPE.itemsize - cut) // DTYPE.itemsize))


def test_after_a_failure_writing_goes_on_at_a_whole_row(tmp_path, monkeypatch):
    with FrameLogWriter(tmp_path / "x.log", DTYPE, {}) as log:
        write = log._write

        def broken(data):
            write(data[: DTYPE.itemsize + 7])
            raise OSError("no space left on device")

        monkeypatch.setattr(log, "_write", broken)
        with pytest.raises(OSError, match="no space"):
            log.append(rows(3))
        assert log.rows == 1
        monkeypatch.setattr(log, "_write", write)
        log.append(rows(2, 1))
    assert read_frame_log(tmp_path / "x.log")[1]["number"].tolist() == [0, 1, 2]


@pytest.mark.parametrize("text", ["", "{}", "no json\n", '{"format": "other", "format_version": 1}\n'])
def test_other_files_are_refused(tmp_path, text):
    path = tmp_path / "x.log"
    with pytest.raises(FileFormatError, match="no such file"):
        read_frame_log(path)
    path.write_text(text)
    with pytest.raises(FileFormatError, match="frame log"):
        read_frame_log(path)
