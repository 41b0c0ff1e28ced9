"""Ground reactions of MOT files under every naming, as wrenches on the body in the world."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.axes import rotation_to_world
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.forces import read_forces_mot
from mbkf.io.records import PlateReadings
from mbkf.io.storage import Table, read_storage, write_storage
from tests.mot_files import write_forces_mot

RATE_HZ = 500.0
SAMPLES = 1000
LOADED = slice(300, 700)
TO_FILE = rotation_to_world("y")
POINT_M = np.array([0.8, 0.2, 0.0])
FORCE_N = np.array([60.0, -20.0, 800.0])
TORQUE_NM = np.array([0.0, 0.0, 6.0])

NAMINGS = {
    "0": ("ground_force_v", "ground_force_p", "ground_torque_"),
    "1": ("1_ground_force_v", "1_ground_force_p", "1_ground_torque_"),
    "r": ("ground_force_r_v", "ground_force_r_p", "ground_torque_r_"),
    "l": ("L_ground_force_v", "L_ground_force_p", "L_ground_torque_"),
    "4": ("ground_force4_v", "ground_force4_p", "ground_torque4_"),
    "left_belt": ("ground_force_left_belt_v", "ground_force_left_belt_p", "ground_torque_left_belt_"),
}


def columns(force_n=FORCE_N, point_m=POINT_M, offset_n=(0.0, 0.0, 0.0)) -> list[np.ndarray]:
    """Force, point and torque columns in the file's axes (y up)."""
    force, point, torque = (np.zeros((SAMPLES, 3)) for _ in range(3))
    force[LOADED], point[LOADED], torque[LOADED] = force_n, point_m, TORQUE_NM
    force += np.array(offset_n)
    return [values @ TO_FILE for values in (force, point, torque)]


def save(path, sets: dict[str, list[np.ndarray]], start_s=2.48):
    names = [f"{prefix}{axis}" for name in sets for prefix in NAMINGS[name] for axis in "xyz"]
    table = Table(
        tuple(names), start_s + np.arange(SAMPLES) / RATE_HZ, np.hstack([c for s in sets.values() for c in s])
    )
    write_storage(table, path)
    return path


def read(path):
    return read_forces_mot(path, CaptureOptions(tare=False, up="y"))


@pytest.mark.parametrize("name", NAMINGS)
def test_each_naming(tmp_path, name):
    (plate,) = read_forces_mot(
        save(tmp_path / "a.mot", {name: columns()}), CaptureOptions(tare=False, up="y")
    )
    assert (plate.name, plate.rate_hz, plate.start_time_s) == (name, RATE_HZ, 2.48)
    np.testing.assert_allclose(plate.origin_m, POINT_M)
    np.testing.assert_allclose(plate.force_n[LOADED], np.tile(FORCE_N, (400, 1)))
    np.testing.assert_allclose(plate.moment_nm[LOADED], np.tile(TORQUE_NM, (400, 1)), atol=1e-9)
    np.testing.assert_allclose(plate.centre_of_pressure_m[LOADED], np.tile(POINT_M, (400, 1)))
    assert np.isnan(plate.centre_of_pressure_m[:300]).all()


def test_sets_keep_their_order_and_names(tmp_path):
    path = save(tmp_path / "a.mot", {name: columns() for name in ("4", "0", "1", "r", "l")})
    assert [plate.name for plate in read(path)] == [
        "4",
        "0",
        "1",
        "r",
        "l",
    ]


def test_moment_about_the_origin_does_not_depend_on_where_the_force_is_said_to_act(tmp_path):
    force, point, torque = columns()
    arm = np.array([0.02, 0.0, -0.03])  # in the file's axes
    moved = [force, point + arm, torque - np.cross(arm, force)]
    (a,) = read_forces_mot(
        save(tmp_path / "a.mot", {"r": [force, point, torque]}), CaptureOptions(tare=False, up="y")
    )
    (b,) = read(save(tmp_path / "b.mot", {"r": moved}))
    about_a = b.moment_nm + np.cross(b.origin_m - a.origin_m, b.force_n)
    np.testing.assert_allclose(about_a, a.moment_nm, atol=1e-8)


def test_offset_is_removed_on_request_only(tmp_path):
    path = save(tmp_path / "a.mot", {"r": columns(offset_n=(1.0, 2.0, -16.0))})
    assert read(path)[0].force_n[0, 2] == pytest.approx(-16.0)
    (plate,) = read_forces_mot(path, CaptureOptions(tare=True, up="y"))
    np.testing.assert_allclose(plate.offset[:3], [1.0, 2.0, -16.0], atol=1e-9)
    np.testing.assert_allclose(plate.force_n[:300], 0.0, atol=1e-9)
    clean = save(tmp_path / "b.mot", {"r": columns(offset_n=(0.3, 0.0, -0.9))})
    np.testing.assert_array_equal(read_forces_mot(clean, CaptureOptions(tare=True, up="y"))[0].offset, 0.0)


@pytest.mark.parametrize("broken", [0, 1, 2])
def test_values_that_are_no_numbers_are_refused(tmp_path, broken):
    sets = columns()
    sets[broken][400, 1] = np.nan
    with pytest.raises(InvalidInput, match=r"set 'r': 1 of 1000 samples .* 3\.280 s"):
        read(save(tmp_path / "a.mot", {"r": sets}))


def test_an_unloaded_plate_needs_no_point_of_application(tmp_path):
    sets = columns()
    sets[1][:300] = np.nan
    (plate,) = read(save(tmp_path / "a.mot", {"r": sets}))
    np.testing.assert_array_equal(plate.moment_nm[:300], 0.0)


def test_unknown_and_incomplete_naming_is_refused(tmp_path):
    for names, error, reason in (
        (("a", "b"), UnknownName, r"a, b.*ground_force_r_vx"),
        (("Fx", "Fy"), FileFormatError, r"column Fz of set '0' is missing"),
    ):
        write_storage(Table(names, np.arange(3.0), np.zeros((3, 2))), tmp_path / "a.mot")
        with pytest.raises(error, match=reason):
            read(tmp_path / "a.mot")
    whole = read_storage(save(tmp_path / "b.mot", {"r": columns()}))
    write_storage(Table(whole.names[:-1], whole.times_s, whole.columns[:, :-1]), tmp_path / "c.mot")
    with pytest.raises(FileFormatError, match="ground_torque_r_z"):
        read(tmp_path / "c.mot")


def test_uneven_times_are_refused_and_rounded_ones_accepted(tmp_path):
    whole = read_storage(save(tmp_path / "a.mot", {"r": columns()}, start_s=0.0))
    rounded = Table(whole.names, np.round(np.arange(SAMPLES) / 600.0, 4), whole.columns)
    write_storage(rounded, tmp_path / "b.mot")
    assert read(tmp_path / "b.mot")[0].rate_hz == pytest.approx(600.0, abs=0.05)
    for times in (np.where(np.arange(SAMPLES) > 500, whole.times_s + 0.1, whole.times_s), np.zeros(SAMPLES)):
        write_storage(Table(whole.names, times, whole.columns), tmp_path / "c.mot")
        with pytest.raises(FileFormatError, match=r"evenly|increase"):
            read(tmp_path / "c.mot")


def promising(path, rows: int, header: str = ""):
    """A file of 1000 rows from 0 to 1.998 s that promises others."""
    text = save(path, {"r": columns()}, start_s=0.0).read_text()
    path.write_text(text.replace("nRows=1000", f"nRows={rows}").replace("endheader", f"{header}endheader"))
    return path


@pytest.mark.parametrize(("until_s", "header"), [(1.998, ""), (1.2, ""), (None, "range 0 1.998\n")])
def test_a_wrong_count_is_told_where_the_rows_last_as_long_as_the_trial(tmp_path, until_s, header):
    notes = []
    path = promising(tmp_path / "a.mot", 5000, header)
    (plate,) = read_forces_mot(path, CaptureOptions(tare=False, up="y", trial_end_s=until_s, notes=notes))
    assert len(plate.force_n) == SAMPLES
    assert notes == ["a.mot promises 5000 rows and has 1000"]


@pytest.mark.parametrize(("until_s", "header"), [(None, ""), (3.0, ""), (None, "range 0 9.998\n")])
def test_rows_that_end_too_early_are_refused(tmp_path, until_s, header):
    path = promising(tmp_path / "a.mot", 5000, header)
    with pytest.raises(FileFormatError, match="cut short: 5000 rows promised, 1000 present"):
        read_forces_mot(path, CaptureOptions(tare=False, up="y", trial_end_s=until_s))


def test_more_rows_than_promised_are_told(tmp_path):
    notes = []
    read_forces_mot(promising(tmp_path / "a.mot", 7), CaptureOptions(tare=False, up="y", notes=notes))
    assert notes == ["a.mot promises 7 rows and has 1000"]


def test_weight_tells_which_axis_is_up_where_nobody_does(tmp_path):
    path = save(tmp_path / "a.mot", {"r": [values @ TO_FILE.T for values in columns()]})
    notes = []
    (plate,) = read_forces_mot(path, CaptureOptions(tare=False, notes=notes))
    np.testing.assert_allclose(plate.force_n[LOADED], np.tile(FORCE_N, (400, 1)))
    assert any("weight along z" in note for note in notes)


def readings(name: str, seed: int) -> PlateReadings:
    rng = np.random.default_rng(seed)
    origin = np.array([0.5, -0.2, 0.0])
    force = rng.normal([0, 0, 600], [20, 20, 50], (200, 3))
    force[:50] = rng.normal(0.0, 2.0, (50, 3))
    moment = rng.normal(0.0, 30.0, (200, 3))
    pressure = origin + np.cross([0.0, 0.0, 1.0], moment) / force[:, 2:]
    pressure[:50] = np.nan
    return PlateReadings(name, 1000.0, 1.5, origin, force, moment, pressure, 20.0)


def test_round_trip(tmp_path):
    plates = (readings("r", 1), readings("l", 2))
    write_forces_mot(plates, tmp_path / "a.mot")
    names = read_storage(tmp_path / "a.mot").names
    assert names[:3] == ("ground_force_r_vx", "ground_force_r_vy", "ground_force_r_vz")
    assert names[9:] == tuple(name.replace("_r_", "_l_") for name in names[:9])
    for plate, back in zip(plates, read(tmp_path / "a.mot"), strict=True):
        assert (back.name, back.rate_hz, back.start_time_s) == (plate.name, 1000.0, 1.5)
        np.testing.assert_allclose(back.force_n, plate.force_n, atol=1e-8)
        np.testing.assert_allclose(back.centre_of_pressure_m, plate.centre_of_pressure_m, atol=1e-9)
        about_origin = back.moment_nm + np.cross(back.origin_m - plate.origin_m, back.force_n)
        np.testing.assert_allclose(about_origin, plate.moment_nm, atol=1e-7)


@pytest.mark.parametrize(
    ("name", "rate_hz", "start_s", "peaks"),
    [
        ("gait2354_walk/subject01_walk1_grf.mot", 600.0, 0.0, {"0": 805, "1": 811}),
        ("rajagopal_walk_run/grf_run.mot", 1000.0, 0.23, {"r": 1977, "l": 1961}),
        ("rajagopal_walk_run/grf_walk.mot", 2000.0, 0.0, {"r": 943, "l": 931}),
        ("synthetic_exact_truth/subject01_walk2_grf.mot", 200.0, 3.38, {"r": 828, "l": 811}),
        (
            "gaitalytics_walk/overground_fullbody_4plates_grf.mot",
            1000.0,
            2.48,
            {"4": 638.5, "1": 669, "2": 658, "3": -29},
        ),
    ],
)
def test_reference_forces(real_data, name, rate_hz, start_s, peaks):
    plates = read(real_data / name)
    assert {plate.name for plate in plates} == set(peaks)
    for plate in plates:
        assert (plate.rate_hz, plate.start_time_s) == (rate_hz, start_s)
        assert plate.force_n[:, 2].max() == pytest.approx(peaks[plate.name], abs=0.7)
