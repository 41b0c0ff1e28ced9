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
        header, found, damaged = read_frame_log(log.path)  # also while it is written
    assert damaged == 0
    assert header == {"rate": 100.0, "names": ["Ä"], "far": float("inf")}
    assert found.dtype == DTYPE
    np.testing.assert_array_equal(found["number"], np.arange(5))
    np.testing.assert_array_equal(found["q"], np.concatenate([rows(3)["q"], rows(2, 3)["q"]]))


SIZE = DTYPE.itemsize + 4
"""A row and its checksum."""


def logged(path, count):
    with FrameLogWriter(path, DTYPE, {}) as log:
        for k in range(count):
            log.append(rows(1, k))
    return path.read_bytes()


@given(cut=st.integers(0, 3 * SIZE))
def test_a_row_that_was_cut_off_is_ignored(tmp_path_factory, cut):
    path = tmp_path_factory.mktemp("log") / "x.log"
    whole = logged(path, 3)
    path.write_bytes(whole[: len(whole) - cut])
    _, found, damaged = read_frame_log(path)
    assert found["number"].tolist() == list(range((3 * SIZE - cut) // SIZE))
    assert damaged == (cut % SIZE > 0)


@given(at=st.integers(0, 5 * SIZE - 1), value=st.integers(1, 255))
def test_rows_before_a_changed_byte_are_kept(tmp_path_factory, at, value):
    path = tmp_path_factory.mktemp("log") / "x.log"
    whole = bytearray(logged(path, 5))
    whole[len(whole) - 5 * SIZE + at] ^= value
    path.write_bytes(whole)
    _, found, damaged = read_frame_log(path)
    assert found["number"].tolist() == list(range(at // SIZE))
    assert damaged == 5 - at // SIZE


@pytest.mark.parametrize("tail", [bytes(7), bytes(SIZE), bytes(10 * SIZE + 3), b"\xff" * 3 * SIZE])
def test_a_tail_of_zeros_or_of_anything_is_left_out(tmp_path, tail):
    whole = logged(tmp_path / "x.log", 4)
    (tmp_path / "x.log").write_bytes(whole + tail)
    _, found, damaged = read_frame_log(tmp_path / "x.log")
    assert found["number"].tolist() == [0, 1, 2, 3]
    assert damaged == -(-len(tail) // SIZE)
    (tmp_path / "x.log").write_bytes(whole + whole[-SIZE:])  # the last block once more
    assert len(read_frame_log(tmp_path / "x.log").rows) == 4


def test_logs_of_before_there_were_checksums_are_read(tmp_path):
    whole = logged(tmp_path / "x.log", 0).replace(b'"format_version": 2', b'"format_version": 1')
    (tmp_path / "x.log").write_bytes(whole + rows(3).tobytes() + b"\0" * 5)
    _, found, damaged = read_frame_log(tmp_path / "x.log")
    assert (found["number"].tolist(), damaged) == ([0, 1, 2], 1)


def test_after_a_failure_writing_goes_on_at_a_whole_row(tmp_path, monkeypatch):
    with FrameLogWriter(tmp_path / "x.log", DTYPE, {}) as log:
        write = log._write

        def broken(data):
            write(data[: SIZE + 7])
            raise OSError("no space left on device")

        monkeypatch.setattr(log, "_write", broken)
        with pytest.raises(OSError, match="no space"):
            log.append(rows(3))
        assert log.rows == 1
        monkeypatch.setattr(log, "_write", write)
        log.append(rows(2, 1))
    assert read_frame_log(tmp_path / "x.log")[1]["number"].tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    "text", ["", "{}", "no json\n", "[" * 100_000 + "\n", '{"format": "other", "format_version": 1}\n']
)
def test_other_files_are_refused(tmp_path, text):
    path = tmp_path / "x.log"
    with pytest.raises(FileFormatError, match="no such file"):
        read_frame_log(path)
    path.write_text(text)
    with pytest.raises(FileFormatError, match="frame log"):
        read_frame_log(path)
