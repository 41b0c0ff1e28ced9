"""Motive's CSV takes against the truth they were written from."""

import numpy as np
import pytest

from benchmarks.any_capture.dialects import write_motive
from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.motive import read_motive
from tests.io.true_capture import check_markers, made_truth


def written(path, start_s=0.0):
    true = made_truth(start_s)
    write_motive(true, path)
    return true


def changed(path, change):
    path.write_text(change(path.read_text()))


@pytest.mark.parametrize("start_s", [0.0, 1.25])
def test_measured_markers_are_read_and_solved_columns_left_out(tmp_path, start_s):
    true = written(tmp_path / "a.csv", start_s)
    capture = read_motive(tmp_path / "a.csv", CaptureOptions())
    check_markers(true, capture.markers)
    assert (capture.up_axis, capture.length_unit, capture.plates) == ("y", "m", ())
    assert capture.notes == ("columns of Rigid Body are solved, not measured, and left out",)


def test_titles_without_their_words_and_more_rows_of_titles(tmp_path):
    true = written(tmp_path / "a.csv")
    changed(
        tmp_path / "a.csv",
        lambda text: text.replace(",Type,", ",,").replace(",Name,", ",,").replace(",ID,", ",Parent,,\n,ID,"),
    )
    check_markers(true, read_motive(tmp_path / "a.csv", CaptureOptions()).markers)


def test_units_come_from_the_header_or_the_caller(tmp_path):
    true = written(tmp_path / "a.csv")
    changed(tmp_path / "a.csv", lambda text: text.replace("Units,Meters", "Units,Centimeters"))
    found = read_motive(tmp_path / "a.csv", CaptureOptions(unit="m")).markers.positions_m
    np.testing.assert_allclose(found, true.markers.positions_m, atol=1e-9)
    with pytest.raises(InvalidInput, match=r"read in cm.*--unit"):
        read_motive(tmp_path / "a.csv", CaptureOptions())
    changed(tmp_path / "a.csv", lambda text: text.replace("Units,Centimeters", "Units,Ells"))
    with pytest.raises(FileFormatError, match=r"'Ells'.*--unit"):
        read_motive(tmp_path / "a.csv", CaptureOptions())
    changed(tmp_path / "a.csv", lambda text: text.replace("Length Units,Ells,", ""))
    assert any("no length unit" in note for note in read_motive(tmp_path / "a.csv", CaptureOptions()).notes)


def test_unlabelled_and_repeated_names(tmp_path):
    written(tmp_path / "a.csv")
    changed(
        tmp_path / "a.csv", lambda text: text.replace("Anna:C", "Unlabeled 1189").replace("Anna:B", "Anna:A")
    )
    capture = read_motive(tmp_path / "a.csv", CaptureOptions())
    assert capture.markers.names[:3] == ("A", "A_2", "*1189")
    assert any("A → A_2" in note for note in capture.notes)


def test_axes_follow_up(tmp_path):
    true = written(tmp_path / "a.csv")
    raw = read_motive(tmp_path / "a.csv", CaptureOptions(up="z")).markers.positions_m
    np.testing.assert_allclose(raw[..., 1], true.markers.positions_m[..., 2], atol=1e-9)
    with pytest.raises(UnknownName, match="axis 'up'"):
        read_motive(tmp_path / "a.csv", CaptureOptions(up="up"))


def test_counts_and_rates_that_disagree_are_told(tmp_path):
    written(tmp_path / "a.csv")
    changed(tmp_path / "a.csv", lambda text: text.replace("Exported Frames,60", "Exported Frames,75"))
    changed(tmp_path / "a.csv", lambda text: text.replace("Export Frame Rate,100", "Export Frame Rate,120"))
    notes = read_motive(tmp_path / "a.csv", CaptureOptions()).notes
    assert any("counts 75 frames, 60 are there" in note for note in notes)
    assert any("120 Hz" in note and "100 Hz" in note for note in notes)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda text: "", "line 1: not an export of Motive"),
        (lambda text: text.replace("Frame,Time", "Row,Time"), "no row of titles"),
        (lambda text: text.replace("Time (Seconds)", "T"), "no column of times"),
        (
            lambda text: text.replace(",Marker", ",Marker Bone"),
            "no measured markers; it holds Rigid Body, Marker B",
        ),
        (lambda text: text.replace("Marker", "X").replace("Rigid Body", "Y"), "no row states which columns"),
        (lambda text: text.replace("Frame Rate,100.000000", "Frame Rate,"), "no Capture Frame Rate"),
        (lambda text: text[: len(text) // 2], "cut short"),
        (lambda text: text.partition("\n0,0,")[0] + "\n", "cut short: no frames"),
        (lambda text: text.replace("\n3,0.03,", "\n3,x,"), "line 11: not a number"),
        (lambda text: text.replace("\n3,0.03,", "\n3,,"), "line 11: the row has no time"),
    ],
)
def test_damaged_takes_give_one_clear_error(tmp_path, change, reason):
    written(tmp_path / "a.csv")
    changed(tmp_path / "a.csv", change)
    with pytest.raises(FileFormatError, match=reason):
        read_motive(tmp_path / "a.csv", CaptureOptions())


def test_other_files_are_no_takes(tmp_path):
    (tmp_path / "a.csv").write_text("time,Fx\n")


def test_a_table_of_inertial_readings_is_named_as_what_it_is(tmp_path):
    path = tmp_path / "foot.csv"
    path.write_text("time,acc_x,acc_y,acc_z\n0.0,0.0,0.0,9.8\n")
    with pytest.raises(FileFormatError, match=r"inertial sensors.*mbkf imu orient"):
        read_motive(path, CaptureOptions())
