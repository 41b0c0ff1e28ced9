"""Qualisys's TSV exports against the truth they were written from."""

import numpy as np
import pytest

from benchmarks.any_capture.dialects import write_qualisys
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.numbered_files import plate_files
from mbkf.io.qualisys import PLATE_FILE, read_forces_qualisys, read_qualisys
from mbkf.io.trc import write_trc
from tests.io.true_capture import check_markers, check_plates, made_truth

BOTH = pytest.mark.parametrize("local", [True, False], ids=["plate axes", "laboratory axes"])


def written(path, local=True, with_times=True, start_s=0.0):
    true = made_truth(start_s)
    write_qualisys(true, path, in_plate_axes=local, with_times=with_times)
    return true


def changed(path, change):
    path.write_text(change(path.read_text()))


@BOTH
@pytest.mark.parametrize(("with_times", "start_s"), [(True, 0.0), (True, 2.5), (False, 0.0)])
def test_markers_and_the_plates_beside_them(tmp_path, local, with_times, start_s):
    true = written(tmp_path / "walk.tsv", local, with_times, start_s)
    capture = read_capture(tmp_path / "walk.tsv")
    check_markers(true, capture.markers)
    check_plates(true, capture.plates)
    assert [plate.name for plate in capture.plates] == ["1", "2"]
    assert (capture.up_axis, capture.length_unit) == ("z", "mm")
    assert any("walk_f_1.tsv, walk_f_2.tsv" in note for note in capture.notes)
    assert any("forces on the plates; turned" in note for note in capture.notes)
    np.testing.assert_allclose(capture.plates[1].corners_m, true.plates[1].corners_m, atol=1e-9)


@BOTH
def test_plates_named_with_forces_join_other_markers(tmp_path, local):
    true = written(tmp_path / "walk.tsv", local)
    write_trc(true.markers, tmp_path / "walk.trc")
    for name in ("walk_f_2.tsv", "walk.tsv"):
        check_plates(true, read_capture(tmp_path / "walk.trc", forces=tmp_path / name).plates)
    plates = read_capture(tmp_path / "walk.tsv", forces=tmp_path / "walk_f_1.tsv").plates
    check_plates(true, plates)


@BOTH
@pytest.mark.parametrize("described", ["", "Force data"])
def test_centres_of_pressure_tell_axes_that_are_not_described(tmp_path, local, described):
    true = written(tmp_path / "walk.tsv", local)
    for path in plate_files(tmp_path / "walk.tsv", PLATE_FILE):
        words = "local (force plate)" if local else "world (lab)"
        changed(path, lambda text, words=words: text.replace(f"Force data in {words} coordinates", described))
    check_plates(true, read_forces_qualisys(tmp_path / "walk_f_1.tsv", CaptureOptions()))


@BOTH
def test_centres_of_pressure_tell_the_unit_of_moments(tmp_path, local):
    true = written(tmp_path / "walk.tsv", local)
    for path in plate_files(tmp_path / "walk.tsv", PLATE_FILE):
        lines = path.read_text().splitlines()
        start = next(i for i, line in enumerate(lines) if line.startswith("SAMPLE"))
        for i in range(start + 1, len(lines)):
            cells = lines[i].split("\t")
            lines[i] = "\t".join(
                [*cells[:5], *(f"{1e3 * float(cell):.12g}" for cell in cells[5:8]), *cells[8:]]
            )
        path.write_text("\n".join(lines) + "\n")
    check_plates(true, read_forces_qualisys(tmp_path / "walk_f_1.tsv", CaptureOptions()))


def test_moments_that_contradict_the_centres_of_pressure_are_told(tmp_path):
    written(tmp_path / "walk.tsv")
    notes = []
    changed(tmp_path / "walk_f_1.tsv", lambda text: text.replace("COP_X\tCOP_Y", "COP_Y\tCOP_X"))
    read_forces_qualisys(tmp_path / "walk_f_1.tsv", CaptureOptions(notes=notes))
    assert any("plate '1': moments and centres of pressure disagree" in note for note in notes)


def test_missing_samples_events_duplicates_and_counts(tmp_path):
    path = tmp_path / "walk.tsv"
    written(path)
    changed(
        path,
        lambda text: (
            text.replace("MARKER_NAMES\tA\tB", "EVENT\tFoot strike\t21\t0.2\nMARKER_NAMES\tA\tA")
            .replace("NO_OF_FRAMES\t60", "NO_OF_FRAMES\t99")
            .replace("NO_OF_MARKERS\t8", "NO_OF_MARKERS\t9")
        ),
    )
    capture = read_qualisys(path, CaptureOptions())
    assert capture.markers.names[:3] == ("A", "A_2", "C")
    assert [(event.label, event.time_s) for event in capture.events] == [("Foot strike", 0.2)]
    assert not capture.markers.present[10:14, 2].any()
    for words in ("A → A_2", "counts 99 frames, 60", "counts 9 markers, 8"):
        assert any(words in note for note in capture.notes), words


def test_without_plates_the_axis_is_told_or_given(tmp_path):
    path = tmp_path / "walk.tsv"
    true = written(path)
    for plate in plate_files(path, PLATE_FILE):
        plate.unlink()
    capture = read_qualisys(path, CaptureOptions())
    assert any("taken as z" in note for note in capture.notes)
    assert capture.plates == ()
    turned = read_qualisys(path, CaptureOptions(up="x", unit="mm")).markers.positions_m
    np.testing.assert_allclose(turned[..., 2], true.markers.positions_m[..., 0], atol=1e-9)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda text: "", "line 1: not a TSV file of Qualisys"),
        (lambda text: text.replace("MARKER_NAMES", "NAMES"), "holds no trajectories"),
        (lambda text: text.replace("INCLUDED\t3D", "INCLUDED\t2D"), "holds no trajectories"),
        (lambda text: text.replace("FREQUENCY\t100", "FREQUENCY\tEXT"), "FREQUENCY is not a rate"),
        (lambda text: text.partition("Frame\t")[0], "cut short: no rows"),
        (lambda text: text[: len(text) // 2], "cut short"),
        (lambda text: text.replace("\n3\t0.02\t", "\n3\t0.02\tx"), "line 15: not a number"),
        (
            lambda text: text.replace("MARKER_NAMES\tA\t", "MARKER_NAMES\t"),
            "26 columns, but 7 markers need 23",
        ),
    ],
)
def test_damaged_trajectories_give_one_clear_error(tmp_path, change, reason):
    written(tmp_path / "walk.tsv")
    changed(tmp_path / "walk.tsv", change)
    with pytest.raises(FileFormatError, match=reason):
        read_qualisys(tmp_path / "walk.tsv", CaptureOptions())


@pytest.mark.parametrize(
    ("change", "error", "reason"),
    [
        (lambda text: text.replace("NO_OF_SAMPLES", "NO_OF"), FileFormatError, "not a TSV file of Qualisys"),
        (
            lambda text: text.replace("Moment_", "Other_"),
            FileFormatError,
            "columns of the moment are missing",
        ),
        (lambda text: text.replace("Force_Y", "Y"), FileFormatError, "column Force_Y of set '0' is missing"),
        (lambda text: text.replace("Force_", "Other_"), UnknownName, "unknown ground reaction columns"),
        (lambda text: text[: -len(text) // 3], FileFormatError, "cut short"),
    ],
)
def test_damaged_plates_give_one_clear_error(tmp_path, change, error, reason):
    written(tmp_path / "walk.tsv")
    changed(tmp_path / "walk_f_1.tsv", change)
    with pytest.raises(error, match=reason):
        read_capture(tmp_path / "walk.tsv")
    assert read_qualisys(tmp_path / "walk.tsv", CaptureOptions(plates=False)).plates == ()


def test_trajectories_are_no_plate(tmp_path):
    path = tmp_path / "walk.tsv"
    written(path)
    for plate in plate_files(path, PLATE_FILE):
        plate.unlink()
    with pytest.raises(FileFormatError, match="holds no force plate"):
        read_forces_qualisys(path, CaptureOptions())


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda text: text.replace("CORNER_POSX", "CORNER"), "it has no usable corners"),
        (lambda text: text.replace("\n9\t0.016\t0", "\n9\t0.016\tnan"), "1 of 300 samples"),
    ],
)
def test_a_plate_that_cannot_be_read_is_left_out_and_the_others_are_used(tmp_path, change, reason):
    true = written(tmp_path / "walk.tsv")
    changed(tmp_path / "walk_f_1.tsv", change)
    found = read_capture(tmp_path / "walk.tsv")
    names = [plate.name for plate in found.plates]
    assert "1" not in names and len(names) == len(true.plates) - 1
    assert any("force plate 1 is left out: " in note and reason in note for note in found.notes)
