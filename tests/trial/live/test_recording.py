"""Rows of a recording become a capture: gaps stay gaps, points get columns, samples of plates their times."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.stream.source import empty_plate
from mbkf.trial.live.log import LiveStream
from mbkf.trial.live.recording import MARKERS_FILE, MOST_POINTS, POINT_DTYPE, open_recording, read_recording

PLATE = empty_plate("left", 1000.0, 2.0, np.array([0.1, 0.2, 0.0]), 10.0, None)
STREAM = LiveStream("walk", 100.0, 2.0, (PLATE,), (), ("LASI", "RASI"))


def recorded(folder, numbers, points=(), indices=(), stream=STREAM):
    """What is read of a recording: marker coordinates are the frame's number, forces the sample's."""
    folder.mkdir()
    files = open_recording(folder, stream, Path("walk.c3d"))
    rows = np.zeros(len(numbers), files.markers.dtype)
    rows["number"], rows["markers"] = numbers, np.reshape(numbers, (len(numbers), 1, 1))
    rows["residuals"] = np.reshape(numbers, (len(numbers), 1))
    bare = np.zeros(len(points), POINT_DTYPE)
    bare["number"], bare["point"] = points, np.arange(len(points))[:, None]
    bare["residual"] = 0.5 * np.arange(len(points))
    samples = np.zeros(len(indices), files.samples.dtype)
    samples["index"], samples["wrench"] = indices, np.reshape(indices, (len(indices), 1, 1))
    for file, some in zip(files, (rows, bare, samples), strict=True):
        if len(some):
            file.append(some)
        file.close()
    return read_recording(folder)


def test_a_run_without_a_recording_has_none(tmp_path):
    assert read_recording(tmp_path) is None


def test_lost_frames_are_gaps_and_time_begins_with_the_first_frame(tmp_path):
    found = recorded(tmp_path / "log", [7, 8, 10], (), range(75, 105))
    assert found.to == Path("walk.c3d").absolute() and found.left_out == ()
    markers, (plate,) = found.capture.markers, found.capture.plates
    assert (markers.names, markers.rate_hz, markers.start_time_s) == (("LASI", "RASI"), 100.0, 0.0)
    np.testing.assert_array_equal(markers.positions_m[:, 1, 2], [7, 8, np.nan, 10])
    np.testing.assert_array_equal(found.residuals_m[:, 1], [7, 8, np.nan, 10])
    # frame 7 is at 2.07 s; so is sample 70
    assert plate.start_time_s == pytest.approx(0.005) and plate.name == "left"
    np.testing.assert_array_equal(plate.force_n[:, 0], np.arange(75, 105))
    np.testing.assert_array_equal(plate.origin_m, PLATE.origin_m)


def test_points_without_names_stand_in_columns_in_their_order(tmp_path):
    found = recorded(tmp_path / "log", [3, 4, 5], [2, 3, 3, 5])
    assert found.capture.markers.names == ("LASI", "RASI", "*1", "*2")
    bare = found.capture.markers.positions_m[:, 2:, 0]
    np.testing.assert_array_equal(bare, [[1, 2], [np.nan, np.nan], [3, np.nan]])
    np.testing.assert_array_equal(found.residuals_m[:, :2], [[3, 3], [4, 4], [5, 5]])
    np.testing.assert_array_equal(found.residuals_m[:, 2:], 0.5 * bare)


def test_frames_with_all_points_that_fit_are_stated(tmp_path):
    found = recorded(tmp_path / "log", [0, 1], [0] * MOST_POINTS + [1] * 5)
    assert len(found.capture.markers.names) == 2 + MOST_POINTS
    (sentence,) = found.left_out
    assert sentence.startswith("recording: 1 frames hold 1000 points without names")


def test_short_gaps_of_plates_are_bridged_and_long_ones_are_zero_and_stated(tmp_path):
    indices = [*range(5), 7, 8, *range(500, 503)]
    found = recorded(tmp_path / "log", [0, 1], (), indices)
    force = found.capture.plates[0].force_n[:, 0]
    np.testing.assert_allclose(force[:9], np.arange(9))
    assert (force[9:500] == 0.0).all() and force[500] == 500.0
    (sentence,) = found.left_out
    assert "491 of 503 samples of plate 'left' never came" in sentence


def test_plates_that_sent_nothing_are_left_out(tmp_path):
    assert recorded(tmp_path / "log", [0, 1]).capture.plates == ()


def test_a_damaged_recording_is_read_as_far_as_it_goes(tmp_path):
    recorded(tmp_path / "log", [0, 1, 2], (), [0, 1])
    file = tmp_path / "log" / MARKERS_FILE
    file.write_bytes(file.read_bytes()[:-3])
    found = read_recording(tmp_path / "log")
    assert found.capture.markers.frames == 2
    assert found.left_out == (
        "recording: 1 frames are left out: recorded_markers.log is damaged from there on",
    )


def test_a_recording_without_frames_is_none(tmp_path):
    with pytest.raises(FileFormatError, match="no frame was written"):
        recorded(tmp_path / "log", [])
