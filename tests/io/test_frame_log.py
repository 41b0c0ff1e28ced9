"""A log keeps every whole row that was written, after any kind of end."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.frame_log import FrameLogWriter, read_frame_log

DTYPE = np.dtype([("number", "<i8"), ("flag", "?"), ("q", "<f8", (2, 3)), ("none", "<f8", (0, 6))])
ON_DISK = DTYPE.itemsize + 4


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
        header, found, left_out = read_frame_log(log.path)  # also while it is written
    assert left_out == 0
    assert header == {"rate": 100.0, "names": ["Ä"], "far": float("inf")}
    assert found.dtype == DTYPE
    np.testing.assert_array_equal(found["number"], np.arange(5))
    np.testing.assert_array_equal(found["q"], np.concatenate([rows(3)["q"], rows(2, 3)["q"]]))


@given(cut=st.integers(0, 3 * ON_DISK))
def test_a_row_that_was_cut_off_is_ignored(tmp_path_factory, cut):
    path = tmp_path_factory.mktemp("log") / "x.log"
    with FrameLogWriter(path, DTYPE, {}) as log:
        log.append(rows(3))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - cut])
    found = read_frame_log(path)
    assert found.rows["number"].tolist() == list(range((3 * ON_DISK - cut) // ON_DISK))
    assert found.left_out == (cut % ON_DISK > 0)


@given(kept=st.integers(0, 3 * ON_DISK), filling=st.sampled_from([b"\0", b"\xff", b"\x80"]))
def test_nothing_is_read_from_the_first_damaged_row_on(tmp_path_factory, kept, filling):
    """A power cut leaves the file's length and noughts in place of what never reached the disk."""
    path = tmp_path_factory.mktemp("log") / "x.log"
    with FrameLogWriter(path, DTYPE, {}) as log:
        log.append(rows(3))
    content = path.read_bytes()
    start = len(content) - 3 * ON_DISK
    path.write_bytes(content[: start + kept] + (3 * ON_DISK - kept) * filling)
    found = read_frame_log(path)
    assert found.rows["number"].tolist() == list(range(kept // ON_DISK))
    assert found.left_out == 3 - kept // ON_DISK


@given(at=st.integers(0, 10_000), bit=st.integers(0, 7))
def test_one_wrong_bit_is_found_wherever_it_is(tmp_path_factory, at, bit):
    path = tmp_path_factory.mktemp("log") / "x.log"
    with FrameLogWriter(path, DTYPE, {"rate": 100.0}) as log:
        log.append(rows(3))
    content = bytearray(path.read_bytes())
    at, start = at % len(content), len(content) - 3 * ON_DISK
    content[at] ^= 1 << bit
    path.write_bytes(bytes(content))
    if at < start:
        with pytest.raises(FileFormatError):
            read_frame_log(path)
        return
    found = read_frame_log(path)
    assert found.rows["number"].tolist() == list(range((at - start) // ON_DISK))
    assert len(found.rows) + found.left_out == 3


def test_a_row_in_the_place_of_another_is_damage(tmp_path):
    path = tmp_path / "x.log"
    with FrameLogWriter(path, DTYPE, {}) as log:
        log.append(rows(4))
    content = path.read_bytes()
    path.write_bytes(content[:-ON_DISK] + content[-2 * ON_DISK : -ON_DISK])
    found = read_frame_log(path)
    assert (found.rows["number"].tolist(), found.left_out) == ([0, 1, 2], 1)


def test_logs_of_version_1_are_read_as_far_as_they_are_whole(tmp_path):
    path = tmp_path / "x.log"
    described = [["number", "<i8", []], ["flag", "|b1", []], ["q", "<f8", [2, 3]], ["none", "<f8", [0, 6]]]
    first = {"format": "mbkf frame log", "format_version": 1, "dtype": described, "header": {"rate": 1.0}}
    path.write_bytes(json.dumps(first).encode() + b"\n" + rows(3).tobytes() + b"cut")
    found = read_frame_log(path)
    assert (found.header, found.rows["number"].tolist(), found.left_out) == ({"rate": 1.0}, [0, 1, 2], 1)


def test_after_a_failure_writing_goes_on_at_a_whole_row(tmp_path, monkeypatch):
    with FrameLogWriter(tmp_path / "x.log", DTYPE, {}) as log:
        write = log._write

        def broken(data):
            write(data[: ON_DISK + 7])
            raise OSError("no space left on device")

        monkeypatch.setattr(log, "_write", broken)
        with pytest.raises(OSError, match="no space"):
            log.append(rows(3))
        assert log.rows == 1
        monkeypatch.setattr(log, "_write", write)
        log.append(rows(2, 1))
    assert read_frame_log(tmp_path / "x.log").rows["number"].tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{}",
        "no json\n",
        '{"format": "other", "format_version": 1}\n',
        '{"format": "mbkf frame log", "format_version": 3}\n',
    ],
)
def test_other_files_are_refused(tmp_path, text):
    path = tmp_path / "x.log"
    with pytest.raises(FileFormatError, match="no such file"):
        read_frame_log(path)
    path.write_text(text)
    with pytest.raises(FileFormatError, match="frame log"):
        read_frame_log(path)
