"""The log of a live run: what was written comes back, and no number in it decides how much memory is asked for."""

import numpy as np
import pytest

from mbkf.filters.record import FIELDS, blank
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.stream.source import empty_plate
from mbkf.trial.live.log import (
    LIMBS_DTYPE,
    LIMBS_FILE,
    MISSING_PER_ROW,
    MOST_MISSING,
    RENAMED,
    LiveLog,
    LiveStream,
    read_live_log,
)

DTYPE = np.dtype([("number", "<i8"), ("footing", "<i8", (2,)), ("q", "<f8", (5,))])


def logged(folder, numbers, indices=(0, 1, 2), dtype=DTYPE):
    """What is read of a log with such numbers of frames and samples."""
    plate = empty_plate("1", 1000.0, 0.0, np.zeros(3), 10.0, None)
    log = LiveLog(folder, LiveStream("x", 100.0, 0.0, (plate,)), dtype, {"filter": "dynamic"}, ["LASI"])
    rows, samples = blank(dtype, len(numbers)), np.zeros(len(indices), log.plates.dtype)
    rows["number"], rows["q"] = numbers, np.arange(len(numbers))[:, None]
    samples["index"], samples["wrench"] = indices, np.arange(len(indices))[:, None, None]
    log.frames.append(rows)
    log.plates.append(samples)
    log.close()
    return read_live_log(folder)


def test_lost_frames_are_blank(tmp_path):
    found = logged(tmp_path / "log", [7, 8, 11], [70, 73])
    assert (found.first, found.left_out) == (7, ())
    assert found.rows["number"].tolist() == [7, 8, 9, 10, 11]
    np.testing.assert_array_equal(found.rows["q"][:, 0], [0, 1, np.nan, np.nan, 2])
    (plate,) = found.stream.plates
    np.testing.assert_array_equal(plate.force_n[:, 0], [0, np.nan, np.nan, 1])
    assert plate.start_time_s == pytest.approx(0.07)


@pytest.mark.parametrize("strange", [2**60, -(2**60), -(2**63), 2**63 - 1, 1, 2, 10**7])
def test_rows_from_a_strange_number_on_are_left_out(tmp_path, strange):
    found = logged(tmp_path / "log", [0, 1, 2, strange], [0, 1, 2, strange, strange])
    assert found.rows["number"].tolist() == [0, 1, 2]
    assert len(found.stream.plates[0].force_n) == 3
    frames, samples = found.left_out
    assert frames.startswith("1 frames are left out")
    assert samples.startswith("2 samples of the plates are left out")


def test_a_gap_may_be_as_long_as_rows_allow(tmp_path):
    most = MOST_MISSING + 2 * MISSING_PER_ROW
    assert len(logged(tmp_path / "a", [0, 1, most + 2]).rows) == most + 3
    assert len(logged(tmp_path / "b", [0, 1, most + 3]).rows) == 2


def test_fields_of_older_logs_have_their_new_names(tmp_path):
    older = [(name, "<f8", (3,)) for name in RENAMED]
    rows = logged(tmp_path / "log", [0, 1], dtype=np.dtype([*DTYPE.descr, *older])).rows
    assert rows.dtype.names == (*DTYPE.names, *RENAMED.values())
    assert set(RENAMED.values()) <= {field.name for field in FIELDS}


def test_limbs_in_doubt_come_back_up_to_a_damaged_one(tmp_path):
    doubts = [LimbDoubt("left_thigh", "turned over", t, t + 0.1, mended=True) for t in (0.5, 2.5)]
    log = LiveLog(tmp_path / "log", LiveStream("x", 100.0, 0.0, ()), DTYPE, {"filter": "dynamic"}, ["LASI"])
    log.frames.append(blank(DTYPE, 1))
    for text in (doubts[0].as_text(), doubts[1].as_text(), "{", doubts[0].as_text()):
        log.limbs.append(np.array([(text.encode(),)], dtype=LIMBS_DTYPE))
    log.close()
    assert read_live_log(tmp_path / "log").limb_doubts == tuple(doubts)


def test_older_logs_have_no_limbs_in_doubt(tmp_path):
    logged(tmp_path / "log", [0, 1])
    (tmp_path / "log" / LIMBS_FILE).unlink()
    assert read_live_log(tmp_path / "log").limb_doubts == ()


@pytest.mark.parametrize("markers", [1, 3, 8])
def test_numbers_of_every_row_are_aligned(tmp_path, markers):
    """Whatever number of markers, each with a flag, a row has."""
    dtype = np.dtype([*DTYPE.descr, ("rejected", "?", (markers,))])
    found = logged(tmp_path / "log", [0, 1, 2], dtype=dtype).rows
    assert all(row[name].flags.aligned for row in found for name in ("q", "footing"))
    np.testing.assert_array_equal(found["q"][:, 0], [0, 1, 2])
