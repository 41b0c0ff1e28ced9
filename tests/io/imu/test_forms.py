"""Every maker's file form: written from one truth it is read as equal arrays; damaged it is refused in a sentence."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.inertial import makers, makers_binary
from benchmarks.inertial.files import difference, forms
from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.imu.apdm import read_apdm
from mbkf.io.imu.by_quantity import is_by_quantity, read_by_quantity
from mbkf.io.imu.c3d_channels import read_c3d_sensors
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.movella_dot import is_movella_dot, read_movella_dot
from mbkf.io.imu.mvnx import read_mvnx
from mbkf.io.imu.xdf import read_xdf

FORMS = forms()
TWO = (makers.truth("left_foot", 1), makers.truth("right_shank", 2))


@pytest.mark.parametrize("name", FORMS)
def test_what_a_maker_writes_is_read(tmp_path, name):
    assert difference(FORMS[name], tmp_path) <= 1.0


ONE_OF_EACH_CONTENT = {(form.without, form.tolerance): name for name, form in FORMS.items()}.values()


@pytest.mark.parametrize("name", ONE_OF_EACH_CONTENT)
def test_a_wrong_sign_would_be_seen(tmp_path, name):
    form = FORMS[name]
    first = replace(form.sensors[0], force=-form.sensors[0].force)
    assert difference(replace(form, sensors=(first, *form.sensors[1:])), tmp_path) > 1.0


WRITERS = {
    "mvnx": lambda folder: makers_binary.mvnx(TWO, folder),
    "apdm": lambda folder: makers_binary.apdm(TWO, folder),
    "xdf": lambda folder: makers_binary.xdf(TWO, folder),
    "c3d": lambda folder: makers_binary.c3d(TWO, folder),
    "dot": lambda folder: makers.movella_dot(TWO[0], folder),
    "zip": lambda folder: makers.phyphox(TWO[0], folder, "zip"),
    "shimmer": lambda folder: makers.shimmer(TWO[0], folder),
    "delsys": lambda folder: makers.delsys(TWO, folder),
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_file_that_was_cut_is_refused_or_read_as_far_as_it_goes(tmp_path, name):
    path = WRITERS[name](tmp_path)
    whole = path.read_bytes()
    samples = read_imu(path)[0].samples
    for share in (0.0, 0.01, 0.3, 0.6, 0.9):
        path.write_bytes(whole[: int(share * len(whole))])
        try:
            found = read_imu(path)
        except MbkfError as error:
            assert str(path) in str(error) or "sensor" in str(error)
            continue
        assert name in ("dot", "shimmer", "delsys"), "a binary file that was cut passes for a whole one"
        assert found[0].samples < samples or name == "delsys"  # whose other channels go on for longer


@pytest.mark.parametrize("name", [name for name in WRITERS if name != "apdm"])
def test_changed_bytes_raise_nothing_but_our_own_errors(tmp_path, name):
    path = WRITERS[name](tmp_path)
    whole = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    rng = np.random.default_rng(0)
    for _ in range(25):
        changed = whole.copy()
        places = rng.integers(0, min(len(whole), 3000), rng.integers(1, 5))
        changed[places] = rng.integers(0, 256, len(places))
        path.write_bytes(changed.tobytes())
        try:
            read_imu(path)
        except MbkfError:
            continue


def test_hdf5_files_of_other_programs_are_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["a"] = 1.0
    with pytest.raises(FileFormatError, match="no sensors"):
        read_apdm(tmp_path / "other.h5")
    with pytest.raises(FileFormatError, match="no such file"):
        read_apdm(tmp_path / "none.h5")


def test_opals_with_one_label_stay_apart(tmp_path):
    same = (TWO[0], replace(TWO[1], name="left_foot"))
    assert [one.name for one in read_apdm(makers_binary.apdm(same, tmp_path))] == [
        "left_foot",
        "left_foot 1235",
    ]


def test_a_dot_without_its_header_asks_for_the_unit_that_no_one_knows(tmp_path):
    path = makers.movella_dot(TWO[0], tmp_path)
    lines = path.read_text().splitlines()
    assert is_movella_dot(path)
    assert read_movella_dot(path, {"gyr": "rad/s"})[0].angular_velocity_rad_s.max() > 50.0
    bare = tmp_path / "bare.csv"
    bare.write_text("\n".join(lines[6:]))
    assert not is_movella_dot(bare)
    (one,) = read_imu(bare)  # counted packets: MT Manager's form, whose rates are rad/s
    assert one.rate_hz == pytest.approx(100.0 / 100.0)


def test_telephones_folders_are_told_from_others(tmp_path):
    (tmp_path / "empty").mkdir()
    assert not is_by_quantity(tmp_path / "empty")
    own = makers.phyphox(TWO[0], tmp_path)
    assert is_by_quantity(own)
    for table in ("Accelerometer", "Linear Acceleration"):
        (own / f"{table}.csv").unlink()
    with pytest.raises(FileFormatError, match="no accelerometer"):
        read_by_quantity(own)


def test_accelerations_without_gravity_alone_are_refused(tmp_path):
    own = makers.phyphox(TWO[0], tmp_path)
    (own / "Accelerometer.csv").unlink()
    with pytest.raises(FileFormatError, match="gravity"):
        read_by_quantity(own)


def test_slower_magnetometers_are_interpolated(tmp_path):
    session = makers.x_imu3(TWO, tmp_path)
    path = session / "left_foot" / "Magnetometer.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([lines[0], *lines[1::5]]) + "\n")
    one = read_imu(session)[0]
    difference_ut = np.nanmax(np.abs(one.magnetic_field - TWO[0].field))
    assert np.isfinite(one.magnetic_field[:-5]).all()
    assert 0.0 < difference_ut < 6.0


def test_a_suit_without_sensors_data_says_what_to_export(tmp_path):
    path = makers_binary.mvnx(TWO, tmp_path)
    text = path.read_text()
    path.write_text(text.replace("sensorFreeAcceleration", "acceleration"))
    with pytest.raises(FileFormatError, match="export sensorFreeAcceleration"):
        read_mvnx(path)
    path.write_text(text.replace('frameRate="100"', 'frameRate="0"'))
    with pytest.raises(InvalidInput, match="frame rate"):
        read_mvnx(path)
    path.write_text(text.replace('type="normal"', 'type="tpose"'))
    with pytest.raises(FileFormatError, match="no frames"):
        read_mvnx(path)


def test_times_of_a_suit_begin_at_the_first_frames_stamp_in_milliseconds(tmp_path):
    path = makers_binary.mvnx([replace(one, time_s=one.time_s + 2.5) for one in TWO], tmp_path)
    found = read_mvnx(path)[0]
    np.testing.assert_allclose(found.time_s, TWO[0].time_s + 2.5, atol=1e-3)


def test_recordings_without_sensors_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_xdf(tmp_path / "none.xdf")
    path = makers_binary.xdf(TWO, tmp_path)
    changed = path.read_bytes().replace(b"<label>Acc", b"<label>Abc").replace(b"<label>Gyro", b"<label>Guro")
    path.write_bytes(changed)
    with pytest.raises(FileFormatError, match="no accelerometer"):
        read_xdf(path)
    path = makers_binary.xdf(TWO, tmp_path)
    path.write_bytes(path.read_bytes().replace(b"deg/s", b"volts"))
    with pytest.raises(InvalidInput, match="--units gyr="):
        read_xdf(path)
    read_xdf(path, {"gyr": "deg/s"})


def test_a_trial_without_sensors_channels_is_refused(tmp_path):
    from mbkf.io.c3d import read_c3d
    from mbkf.io.c3d_write import write_c3d

    path = makers_binary.c3d(TWO, tmp_path)
    assert len(read_c3d_sensors(path)) == 2
    from dataclasses import replace

    capture = read_c3d(path, CaptureOptions())
    write_c3d(replace(capture, analog=()), tmp_path / "b.c3d")
    with pytest.raises(FileFormatError, match="analog channel"):
        read_c3d_sensors(tmp_path / "b.c3d")
    write_c3d(replace(capture, analog=capture.analog[-1:]), tmp_path / "c.c3d")
    with pytest.raises(FileFormatError, match="inertial sensor"):
        read_c3d_sensors(tmp_path / "c.c3d")
