"""One call reads any capture and joins its forces."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.any_capture.forces import readings
from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.axes import rotation_to_world
from mbkf.io.capture import read_capture
from mbkf.io.records import AxesSource, MarkerTrajectories, PlateReadings
from mbkf.io.trc import write_trc
from tests.io.c3d_builder import Plate, build_c3d, standing_points
from tests.io.true_capture import made_truth
from tests.mot_files import write_forces_mot


def forces_file(path, start_s=0.0, samples=500):
    force = np.zeros((samples, 3))
    force[100:400] = [10.0, 20.0, 600.0]
    point = np.where(force[:, 2:] > 0, [0.3, -0.4, 0.0], np.nan)
    plate = PlateReadings("r", 1000.0, start_s, np.array([0.3, -0.4, 0.0]), force, 0.0 * force, point, 20.0)
    write_forces_mot([plate], path)
    return path


def trc_file(path):
    write_trc(MarkerTrajectories(tuple("abcdefgh"), standing_points(50) / 1e3, 100.0), path)
    return path


def test_suffix_chooses_the_reader(tmp_path):
    for path in (build_c3d(tmp_path / "a.c3d", standing_points(50)), trc_file(tmp_path / "A.TRC")):
        capture = read_capture(path)
        np.testing.assert_allclose(capture.markers.positions_m, standing_points(50) / 1e3, atol=1e-6)
        assert capture.plates == ()


@pytest.mark.parametrize("name", ["a.mot", "a.xlsx", "noend"])
def test_other_files_are_refused_with_what_can_be_read(tmp_path, name):
    (tmp_path / name).write_text("")
    with pytest.raises(FileFormatError, match=r"\.c3d, \.trc, \.csv or \.tsv"):
        read_capture(tmp_path / name)


@pytest.mark.parametrize("name", ["none.c3d", "none.trc"])
def test_missing_files_are_refused(tmp_path, name):
    with pytest.raises(FileFormatError, match="no such file"):
        read_capture(tmp_path / name)


def test_forces_join_markers_in_the_same_world(tmp_path):
    capture = read_capture(trc_file(tmp_path / "a.trc"), forces=forces_file(tmp_path / "a.mot"))
    (plate,) = capture.plates
    np.testing.assert_allclose(plate.force_n[200], [10.0, 20.0, 600.0])
    np.testing.assert_allclose(plate.centre_of_pressure_m[200], [0.3, -0.4, 0.0])
    assert any("ground reactions from a.mot" in note for note in capture.notes)


def test_forces_keep_to_the_axes_of_markers_that_share_them(tmp_path):
    """A TRC file and forces of one laboratory, both with z up, read with TRC's usual y."""
    positions = standing_points(50) / 1e3
    turn = rotation_to_world("y")
    write_trc(MarkerTrajectories(tuple("abcdefgh"), positions @ turn.T, 100.0), tmp_path / "z.trc")
    plate = read_capture(trc_file(tmp_path / "a.trc"), forces=forces_file(tmp_path / "a.mot")).plates[0]
    turned = [values @ turn.T for values in (plate.force_n, plate.moment_nm, plate.centre_of_pressure_m)]
    stored = PlateReadings("r", 1000.0, 0.0, turn @ plate.origin_m, *turned, 20.0)
    write_forces_mot([stored], tmp_path / "z.mot")
    right, usual = (read_capture(tmp_path / "z.trc", forces=tmp_path / "z.mot", up=up) for up in ("z", None))
    np.testing.assert_allclose(right.markers.positions_m, positions, atol=1e-6)
    np.testing.assert_allclose(right.plates[0].force_n, plate.force_n, atol=1e-9)
    np.testing.assert_allclose(usual.markers.positions_m, positions @ turn.T, atol=1e-6)
    np.testing.assert_allclose(usual.plates[0].force_n, plate.force_n @ turn.T, atol=1e-9)
    assert any("point along z of their file, which was read with y up" in note for note in usual.notes)


def test_forces_replace_unusable_plates_of_a_c3d_file(tmp_path):
    path = build_c3d(tmp_path / "a.c3d", standing_points(50), plates=(Plate(4, np.zeros((500, 6))),))
    found = read_capture(path)
    assert found.plates == () and "left out: it is of type 4 without CAL_MATRIX" in found.notes[-1]
    capture = read_capture(path, forces=forces_file(tmp_path / "a.mot"))
    assert [plate.name for plate in capture.plates] == ["r"]
    np.testing.assert_allclose(capture.plates[0].force_n[200], [10.0, 20.0, 600.0])


def test_forces_keep_their_times_and_a_mismatch_is_remarked(tmp_path):
    forces = forces_file(tmp_path / "a.mot", start_s=7.0, samples=600)  # longer than the markers
    capture = read_capture(trc_file(tmp_path / "a.trc"), forces=forces)
    assert capture.plates[0].start_time_s == 7.0
    assert any("outside the time of the markers" in note for note in capture.notes)


@pytest.mark.parametrize(
    ("first_frame", "start_s", "begins_s"),
    [(0, 12.4, 0.0), (619, 0.0, 6.19), (20, 0.0, 0.2), (619, 6.19, 6.19)],
)
def test_forces_on_another_clock_that_last_as_long_as_the_markers_are_aligned(
    tmp_path, first_frame, start_s, begins_s
):
    path = build_c3d(tmp_path / "a.c3d", standing_points(50), first_frame=first_frame)
    capture = read_capture(path, forces=forces_file(tmp_path / "a.mot", start_s=start_s))
    assert capture.plates[0].start_time_s == pytest.approx(begins_s)
    assert any("taken as simultaneous" in note for note in capture.notes) == (start_s != begins_s)
    assert not any("outside the time" in note for note in capture.notes)


@pytest.mark.parametrize(("start_s", "told"), [(0.0, False), (0.01, False), (0.2, True), (-0.2, True)])
def test_forces_that_leave_out_a_part_of_the_trial_are_told(tmp_path, start_s, told):
    forces = forces_file(tmp_path / "a.mot", start_s=start_s)
    notes = read_capture(trc_file(tmp_path / "a.trc"), forces=forces).notes
    assert any(f"ground reactions of r last from {start_s:g} to" in note for note in notes) == told


def test_a_wrong_count_of_rows_is_told_where_forces_last_as_long_as_the_markers(tmp_path):
    trc, forces = trc_file(tmp_path / "a.trc"), forces_file(tmp_path / "a.mot")
    text = forces.read_text()
    forces.write_text(text.replace("nRows=500", "nRows=900"))
    assert "a.mot promises 900 rows and has 500" in read_capture(trc, forces=forces).notes
    forces.write_text("\n".join(text.splitlines()[:301]) + "\n")
    with pytest.raises(FileFormatError, match=r"500 rows promised, 291 present, and they end at 0\.290 s"):
        read_capture(trc, forces=forces)


def test_offsets_are_told_once(tmp_path):
    path = forces_file(tmp_path / "a.mot")
    path.write_text(path.read_text().replace("\t0\t0\t0\t", "\t0\t-15\t0\t"))
    notes = read_capture(trc_file(tmp_path / "a.trc"), forces=path).notes
    assert [note for note in notes if "offset" in note] == [
        "set 'r': offset of -15.0 N vertical force removed"
    ]


def test_options_reach_the_readers(tmp_path):
    path, forces = trc_file(tmp_path / "a.trc"), forces_file(tmp_path / "a.mot")
    capture = read_capture(path, forces=forces, up="z", unit="cm", cop_threshold_n=700.0, tare=False)
    assert (capture.up_axis, capture.length_unit) == ("z", "cm")
    np.testing.assert_allclose(capture.plates[0].force_n[200], [10.0, 600.0, -20.0])
    assert np.isnan(capture.plates[0].centre_of_pressure_m).all()


def test_given_axes_hold_for_markers_and_forces(tmp_path):
    """OpenSim's z flipped: markers and centres of pressure mirror y, vertical forces stay."""
    trc, mot = trc_file(tmp_path / "a.trc"), forces_file(tmp_path / "a.mot")
    plain, mirrored = (read_capture(trc, forces=mot, axes=axes) for axes in ("x,-z,y", "x,z,y"))
    flip = np.diag([1.0, -1.0, 1.0])
    np.testing.assert_array_equal(mirrored.markers.positions_m, plain.markers.positions_m @ flip)
    np.testing.assert_allclose(mirrored.plates[0].force_n, plain.plates[0].force_n @ flip)
    np.testing.assert_allclose(
        mirrored.plates[0].centre_of_pressure_m, plain.plates[0].centre_of_pressure_m @ flip
    )
    assert (mirrored.axes, mirrored.axes_source) == ("x,z,y", AxesSource.GIVEN)
    by_default = read_capture(trc, forces=mot)
    np.testing.assert_array_equal(plain.plates[0].moment_nm, by_default.plates[0].moment_nm)
    assert (by_default.axes, by_default.axes_source) == ("x,-z,y", AxesSource.DEFAULT)
    assert read_capture(trc, up="z").axes_source is AxesSource.UP_GIVEN


def test_axes_and_up_may_not_contradict_each_other(tmp_path):
    with pytest.raises(InvalidInput, match="give one"):
        read_capture(trc_file(tmp_path / "a.trc"), up="z", axes="x,-z,y")


def test_a_c3d_tells_where_its_up_is_from(tmp_path):
    assert read_capture(build_c3d(tmp_path / "a.c3d", standing_points(50))).axes_source in AxesSource


DAMAGED = {
    "walk.trc": None,
    "grf0.mot": "walk.trc",
    "y.forces": "walk.trc",
    "take.csv": None,
    "walk_force plate 1.csv": "take.csv",
    "devices.csv": "z.trc",
    "plate_with.tsv": None,
    "plate_with_f_2.tsv": "plate_with.tsv",
    "laboratory_without_f_1.tsv": "walk.trc",
}
"""Files of one true capture in every format, and the markers that forces belong to."""


@pytest.fixture(scope="module")
def every_dialect(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dialects")
    for _ in readings(made_truth(), folder):
        pass
    return folder


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=st.sampled_from(sorted(DAMAGED)), share=st.floats(0.0, 1.0), data=st.data())
def test_a_damaged_file_is_read_or_gives_one_clear_line(every_dialect, name, share, data):
    path = every_dialect / name
    whole = path.read_bytes()
    at = int(share * (len(whole) - 1))
    change = data.draw(st.sampled_from(["cut", "letter", "tab", "line"]))
    parts = {
        "cut": whole[:at],
        "letter": whole[:at] + b"x" + whole[at + 1 :],
        "tab": whole[:at] + b"\t," + whole[at:],
        "line": whole[:at].rpartition(b"\n")[0] + whole[at:].partition(b"\n")[2],
    }
    path.write_bytes(parts[change])
    try:
        markers = DAMAGED[name]
        if markers is None:
            read_capture(path)
        else:
            read_capture(every_dialect / markers, forces=path, up="z" if markers == "z.trc" else None)
    except MbkfError as error:
        assert "\n" not in str(error)
        assert name.partition(".")[0] in str(error)
    finally:
        path.write_bytes(whole)
