"""Damaged tables of every program are refused in one line: each case is a fault that a reader once had or may have."""

from functools import partial

import pytest

from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.forces import read_forces_mot
from mbkf.io.imu.files import read_imu
from mbkf.io.storage import read_storage
from tests.io.damaged.refusal import refusal

TRC = (
    "PathFileType\t4\t(X/Y/Z)\ta.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    "50\t50\t3\t1\tm\t50\t1\t3\nFrame#\tTime\tHead\t\t\n\t\tX1\tY1\tZ1\n\n"
    "1\t0.00\t0.1\t1.5\t0.2\n2\t0.02\t0.1\t1.5\t0.2\n3\t0.04\t0.1\t1.5\t0.2\n"
)
MOTIVE = (
    "Format Version,1.23,Capture Frame Rate,100,Total Exported Frames,3,Length Units,Meters\n\n"
    ",Type,Marker,Marker,Marker\n,Name,A,A,A\n,ID,1,1,1\n,,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z\n0,0.00,0.1,1.5,0.2\n1,0.01,0.1,1.5,0.2\n2,0.02,0.1,1.5,0.2\n"
)
QUALISYS = (
    "NO_OF_FRAMES\t3\nNO_OF_MARKERS\t1\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\tA\n"
    "1\t0.00\t100\t200\t1500\n2\t0.01\t100\t200\t1500\n3\t0.02\t100\t200\t1500\n"
)
CORTEX = (
    "[Force Data]\nNumberOfForcePlates=1\nSampleRate=500\nNumberOfSamples=3\n#Sample FX1 FY1 FZ1 X1 Y1 Z1 MZ1\n"
    "1 0 700 0 10 0 10 0\n2 0 700 0 10 0 10 0\n3 0 700 0 10 0 10 0\n"
)
DEVICES = (
    "Devices\n500\nFrame,Sub Frame,Fx,Fy,Fz,Cx,Cy,Cz\n,,N,N,N,mm,mm,mm\n"
    "1,0,0,0,700,10,10,0\n1,1,0,0,700,10,10,0\n2,0,0,0,700,10,10,0\n2,1,0,0,700,10,10,0\n"
)
PLAIN = "time,Fx,Fy,Fz,COPx,COPy,COPz,Tz\n" + "".join(f"{k / 100},0,0,700,0.1,0.1,0,0\n" for k in range(4))
MOT = (
    "a\nversion=1\nnRows=3\nnColumns=7\ninDegrees=no\nendheader\n"
    "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\n"
    + "".join(f"{k / 100}\t0\t700\t0\t0.1\t0\t0.1\n" for k in range(3))
)
IMU = "time [s],acc_x [m/s^2],acc_y [m/s^2],acc_z [m/s^2]\n" + "".join(
    f"{k / 100},0,0,9.8\n" for k in range(4)
)
XSENS = "// Update Rate: 100.0Hz\nPacketCounter\tAcc_X\tAcc_Y\tAcc_Z\n" + "".join(
    f"{k}\t0\t0\t9.8\n" for k in range(4)
)


def read_mot(path):
    return read_forces_mot(path, CaptureOptions())


def with_forces(path):
    markers = path.parent / "markers.trc"
    markers.write_text(TRC)
    return read_capture(markers, forces=path)


SAMPLES = {
    "a.trc": (read_capture, TRC), "motive.csv": (read_capture, MOTIVE), "q.tsv": (read_capture, QUALISYS),
    "c.forces": (with_forces, CORTEX), "devices.csv": (with_forces, DEVICES), "plain.csv": (with_forces, PLAIN),
    "grf.mot": (read_mot, MOT), "table.sto": (read_storage, MOT), "imu.csv": (read_imu, IMU),
    "xsens.txt": (partial(read_imu), XSENS),
}  # fmt: skip


@pytest.mark.parametrize("name", SAMPLES)
def test_the_undamaged_sample_is_read_with_any_end_of_line(tmp_path, name):
    read, text = SAMPLES[name]
    for content in (text.encode(), text.replace("\n", "\r\n").encode()):
        (tmp_path / name).write_bytes(content)
        assert read(tmp_path / name) is not None


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize(
    "content",
    [
        b"", b"\n" * 200, b"\0" * 512, bytes(range(256)) * 8, b"\xff\xfe" * 100, None, b"[" * 4000, b'"' * 4000,
        b"," * 4000, b"\t" * 4000, b"<a>" * 1000, b"9" * 4000, b"\r" * 100, b"PK\x03\x04" + bytes(60),
        b"\x89HDF\r\n\x1a\n",
    ],
    ids=[
        "empty", "blank lines", "zeros", "all bytes", "marks", "folder", "brackets", "quotation marks", "commas",
        "tabs", "elements", "digits", "returns", "zip", "hdf5",
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused(tmp_path, name, content):
    refusal(SAMPLES[name][0], tmp_path / name, content)


@pytest.mark.parametrize("name", sorted(set(SAMPLES) - {"xsens.txt"}))
def test_programs_on_windows_write_utf_16(tmp_path, name):
    read, text = SAMPLES[name]
    for encoding in ("utf-16", "utf-16-be"):
        mark = "" if encoding == "utf-16" else "\ufeff"
        (tmp_path / name).write_bytes((mark + text).encode(encoding))
        assert read(tmp_path / name) is not None


@pytest.mark.parametrize("name", SAMPLES)
def test_another_encoding_and_a_first_line_alone_are_refused(tmp_path, name):
    read, text = SAMPLES[name]
    refusal(read, tmp_path / name, text.encode("utf-32")[:4000])
    refusal(read, tmp_path / name, text.splitlines()[0].encode())


CASES = [
    ("a.trc", "0.02\t0.1", "0.9\t0.1", "the time"),
    ("a.trc", "0.02\t0.1", "-7\t0.1", "goes back"),
    ("a.trc", "0.02\t0.1", "nan\t0.1", ""),
    (
        "a.trc",
        "3\t0.04\t0.1\t1.5\t0.2\n",
        "3\t0.04\t0.1\t1.5\t0.2\n4\t1.7e308\t0.1\t1.5\t0.2\n",
        "the time jumps",
    ),
    ("a.trc", "50\t50\t3", "1e308\t50\t3", ""),
    ("a.trc", "50\t50\t3", "0\t50\t3", ""),
    ("a.trc", "50\t50\t3", "-50\t50\t3", ""),
    ("a.trc", "\t1\tm\t", "\t1\tparsec\t", "unit"),
    ("a.trc", "0.1\t1.5\t0.2\n2", "abc\t1.5\t0.2\n2", "line 7"),
    ("motive.csv", "1,0.01", "1,0.00", "out of order"),
    ("motive.csv", ",Position,Position", ",Marker,Marker", ""),
    (
        "motive.csv",
        ",Type,Marker,Marker,Marker\n,Name,A,A,A\n,ID,1,1,1\n,,Position,Position,Position\n",
        ",Name,A,A,A\n,Type,Marker,Marker,Marker\n",
        "no row states",
    ),
    ("motive.csv", "1,0.01", "1,nan", "no time"),
    ("motive.csv", "1,0.01", "1,1e308", "out of order"),
    ("motive.csv", "1,0.01", '1,"0.01', ""),
    ("motive.csv", "Rate,100", "Rate,1e300", "rate"),
    ("motive.csv", "Units,Meters", "Units,Ells", "not a unit of length"),
    ("motive.csv", "Frame,Time", "Frame,Tame", "no column of times"),
    ("q.tsv", "2\t0.01", "2\t0.5", "out of order"),
    ("q.tsv", "FREQUENCY\t100", "FREQUENCY\t1e300", "rate"),
    ("q.tsv", "FREQUENCY\t100", "FREQUENCY\t-1", "not a rate"),
    ("q.tsv", "MARKER_NAMES\tA", "MARKER_NAMES", "no trajectories"),
    ("c.forces", "2 0 700", "9 0 700", "out of order"),
    ("c.forces", "2 0 700", "2 0 1e7", "reads a force"),
    ("c.forces", "2 0 700", "2 0 nan", "not numbers"),
    ("c.forces", "2 0 700", "2 0 inf", ""),
    ("c.forces", "2 0 700", "2 1e308 1e308", "larger than 1e+12"),
    ("c.forces", "0 700 0 10 0 10 0\n2 0 700", "inf inf inf 10 0 10 0\n2 inf inf", "not numbers"),
    ("plain.csv", "0.01,0,0,700,0.1", "0.01,0,0,700,1e308", ""),
    ("grf.mot", "0.01\t0\t700", "0.01\t0\t1e308", "larger than 1e+12"),
    ("plain.csv", "0.01,0,0,700", "0.01,0,0,1e308", "larger than 1e+12"),
    ("c.forces", "SampleRate=500", "SampleRate=1e-300", ""),
    ("c.forces", "FX1 FY1", "FX1 FX1", ""),
    ("devices.csv", "1,1,0", "7,1,0", "out of order"),
    ("devices.csv", "1,1,0,0,700", "1,1,0,0,1e9", "reads a force"),
    ("devices.csv", "500\n", "1e300\n", ""),
    ("plain.csv", "0.01,0", "7.5,0", "out of order"),
    ("plain.csv", "0.01,0,0,700", "0.01,0,0,-1e7", "reads a force"),
    ("plain.csv", "Fx,Fy,Fz", "Fx,Fx,Fz", ""),
    ("grf.mot", "0.01\t0", "-0.01\t0", "go back"),
    ("grf.mot", "0.01\t0", "nan\t0", "go back"),
    ("grf.mot", "nRows=3", "nRows=300", "cut short"),
    ("grf.mot", "endheader", "endhead", "endheader"),
    ("table.sto", "time\tground", "tame\tground", "not 'time'"),
    ("table.sto", "0.01\t0\t700", "0.01\tx\t700", "not a number"),
    ("imu.csv", "0.01,0", "7,0", ""),
    ("imu.csv", "0.01,0,0,9.8", "0.01,0,0,9.8e9", "acceleration"),
    ("imu.csv", "0.01,0", "-0.01,0", "time of sample"),
    ("imu.csv", "[m/s^2]", "[furlong]", "unit"),
    ("imu.csv", "0.02,0", '0.02,"0', ""),
    ("xsens.txt", "2\t0", "90000\t0", "does not count packets"),
    ("xsens.txt", "2\t0", "1\t0", "does not count up"),
    ("xsens.txt", "2\t0", "nan\t0", "does not count packets"),
    ("xsens.txt", "100.0Hz", "1.2.3Hz", "rate"),
    ("xsens.txt", "100.0Hz", "0.0Hz", ""),
    ("xsens.txt", "2\t0\t0\t9.8", "2\t0\t0\t1e300", "acceleration"),
]


@pytest.mark.parametrize(("name", "old", "new", "reason"), CASES)
def test_a_damaged_cell_is_refused_for_its_reason(tmp_path, name, old, new, reason):
    read, text = SAMPLES[name]
    assert text.count(old) >= 1
    assert reason in refusal(read, tmp_path / name, text.replace(old, new, 1).encode())
