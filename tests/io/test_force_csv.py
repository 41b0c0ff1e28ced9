"""Tables of forces with named columns, from any program that writes them."""

import numpy as np
import pytest

from benchmarks.any_capture.dialects import write_devices_table, write_plate_tables
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_csv import read_forces_csv
from tests.io.true_capture import check_plates, made_truth

TRUE = made_truth()


def saved(path, text):
    path.write_text(text)
    return path


def read(path, **options):
    return read_forces_csv(path, CaptureOptions(tare=False, **options))


def changed(path, change):
    path.write_text(change(path.read_text()))
    return path


def simple(mark=",", titles=("time", "Fx", "Fy", "Fz", "COPx", "COPy", "COPz", "Tz"), decimal="."):
    """The first true plate as a plain table."""
    plate = TRUE.plates[0]
    rows = np.column_stack([TRUE.times_s, plate.force_n, plate.point_m, plate.torque_nm])
    lines = [mark.join(f"{value:.12g}".replace(".", decimal) for value in row) for row in rows]
    return "\n".join([mark.join(titles), *lines]) + "\n"


@pytest.mark.parametrize(("mark", "decimal"), [(",", "."), ("\t", "."), (";", "."), (";", ","), (" ", ".")])
def test_plain_tables(tmp_path, mark, decimal):
    notes = []
    plates = read_forces_csv(
        saved(tmp_path / "a.csv", simple(mark, decimal=decimal)), CaptureOptions(tare=False, notes=notes)
    )
    check_plates(made_one(), plates)
    assert notes == ["the ground reactions carry weight along z; taken as up in their file (--up changes it)"]


def made_one():
    return type(TRUE)(TRUE.markers, TRUE.plates[:1], TRUE.rate_hz)


def test_all_plates_with_units_a_rate_and_moments_about_their_middles(tmp_path):
    write_devices_table(TRUE, tmp_path / "a.csv")
    check_plates(TRUE, read(tmp_path / "a.csv"))


def test_a_rate_and_frames_give_the_times(tmp_path):
    titles = "Frame,Sub Frame,Fx,Fy,Fz,Cx,Cy,Cz"
    plate = TRUE.plates[0]
    rows = np.column_stack([11 + np.arange(300) // 5, np.arange(300) % 5, plate.force_n, 1e3 * plate.point_m])
    text = "\n".join(",".join(f"{value:.12g}" for value in row) for row in rows)
    head = f"Devices\n500\n,,Plate - Force,,,Plate - CoP,,\n{titles}\n,,N,N,N,mm,mm,mm\n"
    path = saved(tmp_path / "a.csv", f"{head}{text}\n\nTrajectories\n100\n")
    (found,) = read(path)
    assert (found.rate_hz, found.start_time_s) == (500.0, pytest.approx(0.1))
    np.testing.assert_allclose(found.force_n, plate.force_n, atol=1e-9)
    np.testing.assert_allclose(found.origin_m[:2], plate.point_m[plate.force_n[:, 2] > 20, :2].mean(axis=0))


def test_plates_in_files_of_their_own_with_corners(tmp_path):
    first = write_plate_tables(TRUE, tmp_path)
    notes = []
    plates = read(first, notes=notes)
    check_plates(TRUE, plates)
    assert [plate.name for plate in plates] == ["1", "2"]
    np.testing.assert_allclose(plates[1].corners_m, TRUE.plates[1].corners_m, atol=1e-8)
    assert any("read together" in note for note in notes)


def test_corners_in_mm(tmp_path):
    first = write_plate_tables(TRUE, tmp_path)

    def in_mm(line):
        name, *values = line.split(",")
        return ",".join([name, *(f"{1e3 * float(value):.9g}" for value in values)])

    for path in (first, first.with_name("walk_force plate 2.csv")):
        lines = path.read_text().splitlines()
        path.write_text("\n".join(in_mm(line) if "Corner" in line else line for line in lines) + "\n")
    check_plates(TRUE, read(first))


def test_a_file_name_names_the_columns_of_a_table_without_titles(tmp_path):
    columns = [vectors for plate in TRUE.plates for vectors in (plate.force_n, plate.point_m)]
    rows = np.hstack([TRUE.times_s[:, None], *columns])
    path = tmp_path / "stoop_F1Cop1F2Cop2.csv"
    np.savetxt(path, rows, delimiter=",")
    notes = []
    plates = read(path, notes=notes)
    assert [plate.name for plate in plates] == ["1", "2"]
    for plate, truth in zip(plates, TRUE.plates, strict=True):
        np.testing.assert_allclose(plate.force_n, truth.force_n, atol=1e-9)
        pressed = truth.force_n[:, 2] > plate.threshold_n
        np.testing.assert_allclose(plate.centre_of_pressure_m[pressed], truth.point_m[pressed], atol=1e-9)
    assert sum("free moment is taken as 0" in note for note in notes) == 2
    with pytest.raises(FileFormatError, match="no line names the columns of a force"):
        read(path.rename(tmp_path / "stoop.csv"))


@pytest.mark.parametrize(
    ("change", "error", "reason"),
    [
        (lambda text: "", FileFormatError, "no line names the columns"),
        (lambda text: text.replace("time", "sample"), FileFormatError, "neither times nor a sample rate"),
        (lambda text: text.replace("COP", "Q"), FileFormatError, "no point of application"),
        (lambda text: text.partition("\n")[0], FileFormatError, "cut short: no rows"),
        (lambda text: text.replace("\n0.02,", "\n0.02,x"), FileFormatError, "line 12: not a number"),
        (lambda text: text.replace("\n0.02,", "\n0.02,1,2,"), FileFormatError, "line 12: 10 values for 8"),
        (lambda text: text.replace("\n0.02,", "\n0.5,"), FileFormatError, "rows are missing or out of order"),
        (lambda text: text.replace("Fz", "Gz"), FileFormatError, "no line names the columns"),
    ],
)
def test_damaged_tables_give_one_clear_error(tmp_path, change, error, reason):
    path = changed(saved(tmp_path / "a.csv", simple()), change)
    with pytest.raises(error, match=reason):
        read(path)


def test_a_plate_without_pressure_or_corners_is_refused(tmp_path):
    first = write_plate_tables(TRUE, tmp_path)
    changed(first, lambda text: text.replace("Corner", "Edge"))
    with pytest.raises(FileFormatError, match="no point of application"):
        read(first)
    write_plate_tables(TRUE, tmp_path)
    changed(first, lambda text: text.replace("Mx,My,Mz", "a,b,c"))
    with pytest.raises(FileFormatError, match="plate '1' has neither centre of pressure nor moments"):
        read(first)


def test_missing_file_and_unknown_axis(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read(tmp_path / "none.csv")
    with pytest.raises(UnknownName, match="axis 'up'"):
        read(saved(tmp_path / "a.csv", simple()), up="up")


def test_reference_forces(real_data):
    folder = real_data / "stoop_lift_box"
    stem = "neu_t169_f250f350"
    capture = read_capture(folder / f"{stem}.c3d", forces=folder / f"{stem}_F1Cop1F2Cop2.csv")
    weight = sum(plate.force_n[:, 2].mean() for plate in capture.plates)
    assert weight / 9.81 == pytest.approx(81.7, abs=0.5)
    feet = [name for name in capture.markers.names if "HEE" in name or "TOE" in name]
    ground = capture.markers.select(tuple(feet)).positions_m
    low, high = np.nanmin(ground, axis=(0, 1)), np.nanmax(ground, axis=(0, 1))
    for plate in capture.plates:
        pressure = np.nanmean(plate.centre_of_pressure_m, axis=0)
        assert (pressure[:2] > low[:2]).all() and (pressure[:2] < high[:2]).all()
