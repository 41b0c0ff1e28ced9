"""Cortex's .forces files against the truth they were written from."""

import numpy as np
import pytest

from benchmarks.any_capture.dialects import write_cortex
from mbkf.errors import FileFormatError
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.cortex import read_forces_cortex
from tests.io.true_capture import check_plates, made_truth


def written(path, up="y"):
    true = made_truth()
    write_cortex(true, path, up)
    return true


@pytest.mark.parametrize("up", ["x", "y", "z"])
def test_weight_tells_the_axis_and_the_free_moment_is_about_it(tmp_path, up):
    notes = []
    true = written(tmp_path / "a.forces", up)
    plates = read_forces_cortex(tmp_path / "a.forces", CaptureOptions(tare=False, notes=notes))
    check_plates(true, plates)
    assert [plate.name for plate in plates] == ["1", "2"]
    assert any("taken as mm" in note for note in notes)
    assert any(f"weight along {up}" in note for note in notes) == (up != "y")


def test_a_later_first_sample_is_a_later_start(tmp_path):
    path = tmp_path / "a.forces"
    written(path)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:5], *lines[105:]]) + "\n")
    assert read_forces_cortex(path, CaptureOptions(tare=False))[0].start_time_s == pytest.approx(100 / 500.0)


def test_counts_that_disagree_are_told(tmp_path):
    path, notes = tmp_path / "a.forces", []
    written(path)
    text = path.read_text().replace("Samples=300", "Samples=900").replace("Plates=2", "Plates=7")
    path.write_text(text)
    read_forces_cortex(path, CaptureOptions(tare=False, notes=notes))
    assert "the header counts 900 samples, 300 are there" in notes
    assert "the header counts 7 force plates, 2 have columns" in notes


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda text: "", "line 1: not a .forces file"),
        (lambda text: text.replace("#Sample", "Sample"), "no line of column names"),
        (lambda text: "\n".join(text.splitlines()[:5]) + "\n", "line 5: cut short: no rows"),
        (lambda text: text.replace("SampleRate=500.000000", "SampleRate="), "no SampleRate"),
        (lambda text: text[: len(text) // 2], "values for 15 columns"),
        (lambda text: "\n".join(text.splitlines()[:100]), "cut short: the header promises 300 samples, 95"),
        (lambda text: text.replace("FY2", "GY2"), "column FY2 of set '2' is missing"),
        (lambda text: text.replace("\n9\t0", "\n9\tx"), "line 14: not a number"),
    ],
)
def test_damaged_files_give_one_clear_error(tmp_path, change, reason):
    path = tmp_path / "a.forces"
    written(path)
    path.write_text(change(path.read_text()))
    with pytest.raises(FileFormatError, match=reason):
        read_forces_cortex(path, CaptureOptions(tare=False))


def test_a_set_with_a_force_that_is_no_number_is_left_out(tmp_path):
    path, options = tmp_path / "a.forces", CaptureOptions(tare=False)
    written(path)
    path.write_text(path.read_text().replace("\n9\t0", "\n9\tnan"))
    (read,) = read_forces_cortex(path, options)
    assert read.name == "2" and "set '1': 1 of 300 samples" in options.left_out["1"]


def test_reference_forces(real_data):
    folder = real_data / "bmc_walk_run"
    capture = read_capture(folder / "lower_walk1.trc", forces=folder / "lower_walk1.forces")
    peaks = [plate.force_n[:, 2].max() for plate in capture.plates]
    np.testing.assert_allclose(peaks, [0.0, 0.0, 836.15, 816.02, 802.34, 850.84, 0.0])
    feet = capture.markers.positions_m[:, :, 2].min()
    assert abs(feet) < 0.1  # markers and plates stand in one world
    for plate in capture.plates[2:6]:
        assert np.nanmax(np.abs(plate.centre_of_pressure_m[:, 2])) == 0.0
        free = plate.moment_nm - np.cross(plate.centre_of_pressure_m - plate.origin_m, plate.force_n)
        assert np.nanmax(np.abs(free[:, 2])) < 20.0
