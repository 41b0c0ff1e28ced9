"""Whole C3D files: rate, unit, axis, mass, and the reference captures against other software."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.c3d import read_c3d, single_precision
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.forces import read_forces_mot
from mbkf.io.storage import read_storage
from mbkf.io.trc import read_trc
from tests.io.c3d_builder import build_c3d, standing_points


def test_rate_and_start_are_exact(tmp_path):
    markers = read_c3d(
        build_c3d(tmp_path / "a.c3d", rate_hz=59.94, first_frame=120), CaptureOptions()
    ).markers
    assert markers.rate_hz == 59.94
    assert markers.start_time_s == 120 / 59.94
    assert single_precision(float(np.float32(119.88))) == 119.88


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("cm", 0.1), ("m", 0.001), ("Millimeters", 1.0)])
def test_units_a_file_states(tmp_path, unit, factor):
    points = standing_points()
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", points * factor, unit=unit), CaptureOptions())
    np.testing.assert_allclose(capture.markers.positions_m, points / 1e3, rtol=1e-6)


def test_empty_unit_is_millimetre_with_a_remark_and_can_be_overruled(tmp_path):
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", unit=""), CaptureOptions())
    assert capture.length_unit == "mm"
    assert any("POINT:UNITS states no length unit" in note for note in capture.notes)
    metres = build_c3d(tmp_path / "b.c3d", standing_points() / 1e3, unit="")
    with pytest.raises(InvalidInput, match="--unit"):
        read_c3d(metres, CaptureOptions())
    np.testing.assert_allclose(
        read_c3d(metres, CaptureOptions(unit="m")).markers.positions_m, standing_points() / 1e3, rtol=1e-6
    )


def test_unknown_unit_and_axis_are_refused(tmp_path):
    path = build_c3d(tmp_path / "a.c3d", unit="parsec")
    with pytest.raises(FileFormatError, match=r"'parsec'.*--unit"):
        read_c3d(path, CaptureOptions())
    assert read_c3d(path, CaptureOptions(unit="mm")).length_unit == "mm"
    with pytest.raises(UnknownName, match="axis 'q'"):
        read_c3d(path, CaptureOptions(unit="mm", up="q"))


@pytest.mark.parametrize(("screen", "up"), [("+Z", "z"), ("Y", "y"), ("-X", "-x"), ("", "z")])
def test_screen_axes_tell_what_points_up_where_there_are_no_plates(tmp_path, screen, up):
    extra = {("POINT", "Y_SCREEN"): [screen]} if screen else {}
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", extra=extra), CaptureOptions())
    assert capture.up_axis == up
    assert any("taken as z" in note for note in capture.notes) == (screen == "")
    assert read_c3d(build_c3d(tmp_path / "b.c3d", extra=extra), CaptureOptions(up="y")).up_axis == "y"


def test_y_up_files_are_turned(tmp_path):
    points = standing_points()
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", points), CaptureOptions(up="y"))
    x, y, z = np.moveaxis(points / 1e3, 2, 0)
    np.testing.assert_allclose(capture.markers.positions_m, np.stack([x, -z, y], axis=2), rtol=1e-6)


def test_body_mass(tmp_path):
    extra = {("PROCESSING", "Bodymass"): [63.6]}
    assert read_c3d(build_c3d(tmp_path / "a.c3d", extra=extra), CaptureOptions()).subject_mass_kg == 63.6
    assert read_c3d(build_c3d(tmp_path / "b.c3d"), CaptureOptions()).subject_mass_kg is None


def test_overground_trial_against_the_export_of_another_program(real_data):
    folder = real_data / "gaitalytics_walk"
    exported = folder / "overground_fullbody_4plates_grf.mot"
    for tare in (False, True):
        capture = read_c3d(folder / "overground_fullbody_4plates.c3d", CaptureOptions(tare=tare))
        reference = {
            plate.name: plate for plate in read_forces_mot(exported, CaptureOptions(tare=tare, up="y"))
        }
        assert {plate.name for plate in capture.plates} == set(reference)
        for plate in capture.plates:
            other = reference[plate.name]
            assert plate.start_time_s == pytest.approx(other.start_time_s, abs=1e-9)
            np.testing.assert_allclose(plate.force_n, other.force_n, atol=1e-4)
            assert (other.force_n[:, 2] > 400).any() == (plate.name != "3")
            if not tare:
                loaded = ~np.isnan(plate.centre_of_pressure_m[:, 0])
                difference = plate.centre_of_pressure_m[loaded] - other.centre_of_pressure_m[loaded]
                assert np.abs(difference).max(initial=0.0) < 1e-5
    assert capture.plates[2].offset[2] == pytest.approx(-31.7, abs=0.1)
    assert capture.plates[3].offset[2] == pytest.approx(-16.0, abs=0.1)
    assert len(capture.markers.names) == 33
    assert len(capture.derived) == 158
    assert len(capture.events) == 13
    assert capture.subject_mass_kg == 63.6
    assert capture.markers.start_time_s == 2.48


@pytest.mark.parametrize(
    ("name", "height"), [("std_walking2_grfs", "origin"), ("std_cop_walking2_grfs", "cop")]
)
def test_plates_against_opensim(real_data, name, height):
    folder = real_data / "opensim_gappy_walk"
    capture = read_c3d(folder / "walking2.c3d", CaptureOptions(tare=False))
    table = read_storage(folder / "reference" / f"{name}.sto")
    for number, plate in enumerate(capture.plates, start=1):
        force, point, moment = (
            np.column_stack([table.column(f"{kind}{number}_{axis}") for axis in (1, 2, 3)]) for kind in "fpm"
        )
        at = np.round(table.times_s * plate.rate_hz).astype(int)
        np.testing.assert_allclose(plate.force_n[at], force, atol=1e-6)
        about_origin = moment / 1e3 + np.cross(point / 1e3 - plate.origin_m, force)
        np.testing.assert_allclose(plate.moment_nm[at], about_origin, atol=1e-6)
        if height == "cop":
            loaded = force[:, 2] >= plate.threshold_n
            assert loaded.sum() >= 10
            np.testing.assert_allclose(plate.centre_of_pressure_m[at][loaded], point[loaded] / 1e3, atol=1e-8)


def test_markers_against_opensim(real_data):
    folder = real_data / "opensim_gappy_walk"
    markers = read_c3d(folder / "walking2.c3d", CaptureOptions()).markers
    assert len(markers.names) == 38
    assert 100 * (~markers.present).mean() == pytest.approx(47.53, abs=0.005)
    reference = read_trc(folder / "reference" / "std_walking2_markers.trc", CaptureOptions(up="z")).markers
    every_tenth = markers.positions_m[np.append(np.arange(0, 1249, 10), 1248)]
    # OpenSim counted its frames with the time step of the table, so compare by frame, not by time.
    np.testing.assert_allclose(every_tenth, reference.select(markers.names).positions_m, atol=1e-4)


@pytest.mark.parametrize(
    ("name", "measured", "frames", "start_s", "weight_n"),
    [
        ("HC032A_Static_HC032A01", 65, 300, 0.0, 592.0),
        ("HC032A_Straight_HC032A03", 59, 211, 1.4, None),
        ("HC044A_Static_HC044A01", 67, 300, 0.0, 388.0),
        ("HC044A_Straight_HC044A15", 59, 285, 1.52, None),
    ],
)
def test_trials_with_more_than_255_points(real_data, name, measured, frames, start_s, weight_n):
    capture = read_c3d(real_data / "biomechzoo_walk_turn" / f"{name}.c3d", CaptureOptions())
    assert len(capture.markers.names) == measured
    assert len(capture.markers.names) + len(capture.derived) > 255
    assert {"LHFB", "RHFB", "LD5M"} <= set(capture.markers.names)
    assert {d.name for d in capture.derived} >= {"LHJC", "PELO", "LArchHeight", "LPROXFF", "CentreOfMass"}
    assert (capture.markers.frames, capture.markers.start_time_s) == (frames, start_s)
    assert capture.markers.present.all()
    for plate in capture.plates:
        np.testing.assert_array_equal(plate.offset, 0.0)
    if weight_n is not None:
        assert np.median(capture.plates[0].force_n[:, 2]) == pytest.approx(weight_n, abs=0.5)
        np.testing.assert_array_equal(capture.plates[1].force_n, 0.0)


def test_unlabelled_trial(real_data):
    folder = real_data / "autolabel_unlabelled_fullbody"
    markers = read_c3d(folder / "S09_KneeltoRun02_UNLABELLED.c3d", CaptureOptions()).markers
    assert markers.names == tuple(f"*{i}" for i in range(75))
    seen = markers.present.sum(axis=1)
    assert (seen.min(), np.median(seen), seen.max()) == (32, 70, 74)
    labelled = read_c3d(folder / "PronetoRun01_labelled.c3d", CaptureOptions()).markers
    assert len(labelled.names) == 62
    assert 100 * (~labelled.present).mean() == pytest.approx(2.46, abs=0.005)
