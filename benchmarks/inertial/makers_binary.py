"""Files of makers of inertial sensors, written by their published descriptions from one truth: XML and binary forms."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import h5py
import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.inertial.makers import DEGREES, RATE_HZ, Truth
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import AnalogChannel, Capture, MarkerTrajectories


def mvnx(sensors: Sequence[Truth], folder: Path, own_turning: bool = False) -> Path:
    """An export of MVN (version 4): frames of calibration before those of the movement.

    Args:
        sensors: The sensors, called as segments.
        folder: Where to write.
        own_turning: Whether sensors' angular velocities stand in the file, as in version 3, in place of those of the
            segments.
    """

    def texts(values: Sequence[Array], row: int) -> str:
        return " ".join(repr(float(value)) for one in values for value in one[row])

    world = [np.asarray(Rotation.from_quat(one.turn).apply(one.turning)) for one in sensors]
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<mvnx xmlns="http://www.xsens.com/mvn/mvnx" version="4">',
        f'<subject label="P1" frameRate="{RATE_HZ:g}" segmentCount="{len(sensors)}">',
        "<segments>",
        *(
            f'<segment label={quoteattr(one.name)} id="{k}"><points/></segment>'
            for k, one in enumerate(sensors, 1)
        ),
        "</segments>",
        "<sensors>",
        *(f"<sensor label={quoteattr(one.name)}/>" for one in sensors),
        "</sensors>",
        f'<frames segmentCount="{len(sensors)}" sensorCount="{len(sensors)}">',
    ]
    for kind in ("identity", "tpose", "tpose-isb"):
        still = " ".join(["1 0 0 0"] * len(sensors))
        lines.append(f'<frame time="0" index="" type="{kind}"><orientation>{still}</orientation></frame>')
    for row, time in enumerate(sensors[0].time_s):
        turning = (
            f"<sensorAngularVelocity>{texts([one.turning for one in sensors], row)}</sensorAngularVelocity>"
            if own_turning
            else f"<angularVelocity>{texts(world, row)}</angularVelocity>"
        )
        lines += [
            f'<frame time="{round(1e3 * time)}" index="{row}" type="normal">',
            turning,
            f"<sensorFreeAcceleration>{texts([one.free for one in sensors], row)}</sensorFreeAcceleration>",
            f"<sensorMagneticField>{texts([one.field for one in sensors], row)}</sensorMagneticField>",
            f"<sensorOrientation>{texts([one.wxyz for one in sensors], row)}</sensorOrientation>",
            "</frame>",
        ]
    path = folder / "suit.mvnx"
    path.write_text("\n".join([*lines, "</frames></subject></mvnx>"]) + "\n", encoding="utf-8")
    return path


def apdm(sensors: Sequence[Truth], folder: Path, version: int = 5) -> Path:
    """A recording of Opals: as Mobility Lab (version 5) or Motion Studio (version 3) arranges it.

    Args:
        sensors: The sensors.
        folder: Where to write.
        version: Of the maker's program.
    """
    path = folder / f"opal{version}.h5"
    with h5py.File(path, "w") as file:
        if version < 5:
            file.attrs["MonitorLabelList"] = np.array(
                [one.name.ljust(16, "\0") for one in sensors], dtype="S16"
            )
            file.attrs["CaseIdList"] = np.array(
                [f"SI-{700 + k:06d}" for k in range(len(sensors))], dtype="S16"
            )
        for k, one in enumerate(sensors):
            micros = (1_600_000_000_000_000 + np.round(1e6 * one.time_s)).astype(np.uint64)
            quantities = {"Accelerometer": one.force, "Gyroscope": one.turning, "Magnetometer": one.field}
            if version < 5:
                group = file.create_group(f"SI-{700 + k:06d}".replace("SI-", "Opal_"))
                group["Time"] = micros
                for name, values in quantities.items():
                    group[f"Calibrated/{name}s"] = values
                group["Calibrated/Orientation"] = one.wxyz
                continue
            group = file.create_group(f"Sensors/{1234 + k}")
            group["Time"] = micros
            for name, values in quantities.items():
                group[name] = values
            group.create_group("Configuration").attrs["Label 0"] = np.bytes_(one.name)
            file[f"Processed/{1234 + k}/Orientation"] = one.wxyz
    return path


def xdf(sensors: Sequence[Truth], folder: Path) -> Path:
    """A recording of LabRecorder with a stream for each sensor and one of markers, by XDF's specification 1.0."""
    path = folder / "recording.xdf"
    out = bytearray(b"XDF:")

    def chunk(tag: int, content: bytes) -> None:
        length = struct.pack("<I", len(content) + 2)
        out.extend(b"\x04" + length + struct.pack("<H", tag) + content)

    chunk(1, b'<?xml version="1.0"?><info><version>1.0</version></info>')
    for number, one in enumerate(sensors, start=1):
        quantities = (("Acc", "g"), ("Gyro", "deg/s"), ("Mag", "uT"))
        channels = "".join(
            f"<channel><label>{name}{axis}</label><unit>{unit}</unit></channel>"
            for name, unit in quantities
            for axis in "XYZ"
        )
        header = (
            f'<?xml version="1.0"?><info><name>{one.name}</name><type>IMU</type><channel_count>9</channel_count>'
            f"<nominal_srate>{RATE_HZ:g}</nominal_srate><channel_format>double64</channel_format>"
            f"<created_at>0</created_at><desc><channels>{channels}</channels></desc></info>"
        )
        chunk(2, struct.pack("<I", number) + header.encode())
        values = np.column_stack([one.force / GRAVITY_M_S2, DEGREES * one.turning, one.field])
        for part in np.array_split(np.arange(len(values)), 4):
            stamps = [struct.pack("<d", 5000.0 + one.time_s[row]) for row in part]
            samples = b"".join(
                b"\x08" + stamp + values[row].astype("<f8").tobytes()
                for stamp, row in zip(stamps, part, strict=True)
            )
            chunk(3, struct.pack("<I", number) + b"\x04" + struct.pack("<I", len(part)) + samples)
    markers = (
        '<?xml version="1.0"?><info><name>events</name><type>Markers</type><channel_count>1</channel_count>'
        "<nominal_srate>0</nominal_srate><channel_format>string</channel_format><desc/></info>"
    )
    chunk(2, struct.pack("<I", 99) + markers.encode())
    for number in (*range(1, len(sensors) + 1), 99):
        chunk(
            6, struct.pack("<I", number) + b'<?xml version="1.0"?><info><sample_count>0</sample_count></info>'
        )
    path.write_bytes(bytes(out))
    return path


def c3d(sensors: Sequence[Truth], folder: Path) -> Path:
    """A trial of a camera system that records the sensors' channels, numbered, beside its markers."""
    time = sensors[0].time_s
    points = np.tile(np.array([[0.1, 0.2, 0.9], [0.3, 0.2, 1.2], [0.2, 0.1, 0.1]]), (len(time), 1, 1))
    markers = MarkerTrajectories(("A", "B", "C"), points, RATE_HZ, start_time_s=float(time[0]))
    channels = []
    for one in sensors:
        for word, unit, values in (
            ("ACC", "g", one.force / GRAVITY_M_S2),
            ("GYRO", "deg/s", DEGREES * one.turning),
        ):
            channels += [
                AnalogChannel(f"{one.name}.{word}.{axis}", column, unit, RATE_HZ)
                for axis, column in zip("XYZ", values.T, strict=True)
            ]
        channels.append(AnalogChannel(f"{one.name}.EMG", 1e-4 * time, "V", RATE_HZ))
    path = folder / "trial.c3d"
    write_c3d(Capture(path=str(path), markers=markers, analog=tuple(channels)), path)
    return path
