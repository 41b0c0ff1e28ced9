"""Files of makers of inertial sensors, written by their published descriptions from one truth: forms of text.

What stands here is independent of the readers: each writer prints the truth in the maker's own units and arrangement.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array

RATE_HZ, SAMPLES = 100.0, 400
DEGREES = 180.0 / np.pi


@dataclass(frozen=True)
class Truth:
    """What one sensor reads.

    Attributes:
        name: The segment.
        time_s: (T,) s.
        force: (T, 3) specific force, m/s².
        turning: (T, 3) angular velocity, rad/s, in the sensor's axes.
        field: (T, 3) magnetic field, µT.
        turn: (T, 4) sensor → world with z up, (x, y, z, w).
    """

    name: str
    time_s: Array
    force: Array
    turning: Array
    field: Array
    turn: Array

    @property
    def free(self) -> Array:
        """(T, 3) acceleration without gravity in the world, m/s²."""
        return np.asarray(Rotation.from_quat(self.turn).apply(self.force)) - [0.0, 0.0, GRAVITY_M_S2]

    @property
    def wxyz(self) -> Array:
        """(T, 4) quaternions with the scalar first."""
        return self.turn[:, [3, 0, 1, 2]]


def truth(name: str, seed: int, start_s: float = 0.0, samples: int = SAMPLES) -> Truth:
    """A sensor that swings and turns, sampled at :data:`RATE_HZ`.

    Args:
        name: The segment.
        seed: Of its motion.
        start_s: Time of the first sample.
        samples: Number of samples.
    """
    rng = np.random.default_rng(seed)
    times = start_s + np.arange(samples) / RATE_HZ
    phases = rng.uniform(0.0, 2.0 * np.pi, (3, 3))

    def waves(size: float, row: int) -> Array:
        return size * np.sin(2.0 * np.pi * np.array([0.7, 1.1, 1.9]) * times[:, None] + phases[row])

    turn = Rotation.from_rotvec(waves(1.2, 0)) * Rotation.from_rotvec(rng.normal(size=3))
    force = turn.inv().apply(np.add(waves(6.0, 1), [0.0, 0.0, GRAVITY_M_S2]))
    return Truth(name, times, force, waves(3.0, 2), turn.inv().apply([0.0, 22.0, -40.0]), turn.as_quat())


def _lines(rows: Array, mark: str = ",", comma: bool = False) -> list[str]:
    """Rows of numbers; NaN is blank."""
    texts = [["" if np.isnan(value) else repr(float(value)) for value in row] for row in rows]
    return [mark.join(cell.replace(".", ",") if comma else cell for cell in row) for row in texts]


def _write(path: Path, lines: Sequence[str], encoding: str = "utf-8") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding=encoding)
    return path


def _axes(name: str) -> list[str]:
    return [name.format(axis) for axis in "XYZ"]


def mt_manager(one: Truth, folder: Path, mark: str = "\t", quaternion: bool = True) -> Path:
    """A text export of MT Manager; its last packets turn the counter over, and one is lost.

    Args:
        one: The sensor.
        folder: Where to write.
        mark: What stands between cells.
        quaternion: Whether orientations are exported.
    """
    count = (65400 + np.arange(len(one.time_s))) % 65536
    names = ["PacketCounter", "SampleTimeFine", *_axes("Acc_{}"), *_axes("Gyr_{}"), *_axes("Mag_{}")]
    parts = [count[:, None], np.full((len(count), 1), np.nan), one.force, one.turning, one.field]
    if quaternion:
        names += [f"Quat_q{k}" for k in range(4)]
        parts.append(one.wxyz)
    rows = np.delete(np.column_stack(parts), 200, axis=0)
    head = [
        "// Start Time: Unknown",
        "// Update Rate: 100.0Hz",
        "// Firmware Version: 4.0.2",
        mark.join(names),
    ]
    suffix = "csv" if mark == "," else "txt"
    return _write(folder / f"MT_0001-000_{one.name}.{suffix}", head + _lines(rows, mark))


def xsens_counter(one: Truth, folder: Path) -> Path:
    """An export of an early MT software: a counter, the rate in a comment, a tab at the end of rows."""
    names = [
        "Counter",
        *_axes("Acc_{}"),
        *_axes("Gyr_{}"),
        *_axes("Mag_{}"),
        *(f"Quat_{axis}" for axis in "wxyz"),
    ]
    count = 2552.0 + np.arange(len(one.time_s))
    rows = np.column_stack([count, one.force, one.turning, one.field, one.wxyz])
    head = ["// Start Time: 0", "// Sample rate: 100.0Hz", "// Firmware Version: 2.5.1", "\t".join(names)]
    return _write(folder / f"{one.name}.txt", [*head, *(f" {line}\t" for line in _lines(rows, "\t"))])


def apdm_csv(sensors: Sequence[Truth], folder: Path) -> Path:
    """An export of Motion Studio: sensor, quantity and axis in a name, units below, the rate above."""
    names, units, parts = ["Time"], ["s"], [sensors[0].time_s[:, None]]
    for one in sensors:
        for quantity, unit, values in (
            ("Acceleration", "m/s^2", one.force), ("Angular Velocity", "rad/s", one.turning),
            ("Magnetic Field", "uT", one.field),
        ):  # fmt: skip
            names += _axes(f"{one.name}/{quantity}/{{}}")
            units += [unit] * 3
            parts.append(values)
        names += [f"{one.name}/Orientation/{axis}" for axis in ("Scalar", *"XYZ")]
        names += [f"{one.name}/Temperature/Scalar"]
        units += [""] * 4 + ["deg C"]
        parts += [one.wxyz, np.full((len(one.time_s), 1), 22.0)]
    blank = "," * (len(names) - 3)
    head = [f"Test Name:,a walk,{blank}", f"Sample Rate:,100,Hz{blank}", ",".join(names), ",".join(units)]
    return _write(folder / "apdm.csv", [*head, *_lines(np.column_stack(parts))])


def repo_imu(one: Truth, folder: Path) -> Path:
    """A trial of RepoIMU: quantities over the axes that they span, no units, quaternions of the cameras."""
    groups = "Time (s)", *("Vicon Orientation", *[""] * 3), *("IMU Acceleration", "", "")
    groups = *groups, *("IMU Gyroscope", "", ""), *("IMU Magnetometer", "", "")
    rows = np.column_stack([one.time_s, one.wxyz, one.force, one.turning, one.field])
    lines = [";".join(groups), ";".join(["", *"WXYZ", *"XYZ" * 3]), *_lines(rows, ";")]
    return _write(folder / "trial.csv", lines)


def packets(one: Truth, folder: Path, size: int = 4) -> Path:
    """A table whose logger gives one stamp to all samples of a packet.

    Args:
        one: The sensor.
        folder: Where to write.
        size: Samples in a packet.
    """
    stamps = np.repeat(one.time_s[::size] + 0.5 * (size - 1) / RATE_HZ, size)[: len(one.time_s)]
    names = _axes("Accelerometer {} (g)") + _axes("Gyroscope {} (deg/s)") + _axes("Magnetometer {} (uT)")
    rows = np.column_stack([stamps, one.force / GRAVITY_M_S2, DEGREES * one.turning, one.field])
    return _write(folder / f"{one.name}.csv", [",".join(["Time (s)", *names]), *_lines(rows)])


def movella_dot(one: Truth, folder: Path, orientation_only: bool = False) -> Path:
    """A file of the DOT app, with everything or with orientation and free acceleration alone.

    Args:
        one: The sensor.
        folder: Where to write.
        orientation_only: Whether readings are left out.
    """
    micros = np.round(1e6 * (one.time_s + 4290.0)) % 2**32  # turns over within the recording
    count = np.arange(len(micros))
    if orientation_only:
        names = [
            "PacketCounter",
            "SampleTimeFine",
            "Quat_W",
            "Quat_X",
            "Quat_Y",
            "Quat_Z",
            *_axes("FreeAcc_{}"),
            "Status",
        ]
        parts = [count, micros, *one.wxyz.T, *one.free.T, 0 * count]
    else:
        names = ["PacketCounter", "SampleTimeFine", *_axes("Acc_{}"), *_axes("Gyr_{}"), *_axes("Mag_{}")]
        parts = [count, micros, *one.force.T, *(DEGREES * one.turning).T, *one.field.T]
    head = [
        "sep=,",
        f"DeviceTag:,{one.name}",
        "FirmwareVersion:,2.1.0",
        "OutputRate:,100Hz",
        "SyncStatus:,Synced",
        "",
    ]
    return _write(folder / "D422CD00_20260101.csv", [*head, ",".join(names), *_lines(np.column_stack(parts))])


def shimmer(one: Truth, folder: Path) -> Path:
    """A session file of Consensys: tabs, names with the device, units below them, two accelerometers."""
    device = "Shimmer_6A92"
    quantities = {"Accel_LN": "m/(s^2)", "Accel_WR": "m/(s^2)", "Gyro": "deg/s", "Mag": "local_flux"}
    names, units = [f"{device}_Timestamp_Unix_CAL"], ["ms"]
    for quantity, unit in quantities.items():
        names += [f"{device}_{quantity}_{axis}_CAL" for axis in "XYZ"]
        units += [unit] * 3
    near = np.clip(one.force, -19.6, 19.6)  # the low-noise one ends at 2 g
    stamps = 1.6e12 + 1e3 * one.time_s
    rows = np.column_stack([stamps, near, one.force, DEGREES * one.turning, one.field])
    return _write(folder / "shimmer.csv", ["sep=\t", "\t".join(names), "\t".join(units), *_lines(rows, "\t")])


def shimmer_connect(one: Truth, folder: Path) -> Path:
    """A file of ShimmerConnect: device, signal, whether calibrated and unit in a row each, raw counts beside them."""
    rows: list[list[str]] = [[], [], []]
    parts = [1e3 * one.time_s]
    for quantity, unit, values in (
        ("Accelerometer", "m/(sec^2)", one.force),
        ("Gyroscope", "deg/sec", DEGREES * one.turning),
        ("Magnetometer", "local flux", one.field),
    ):
        for k, axis in enumerate("XYZ"):
            for form, written, scale in (("RAW", "no units", 100.0), ("CAL", unit, 1.0)):
                for row, cell in zip(rows, (f"{quantity} {axis}", form, written), strict=True):
                    row.append(cell)
                parts.append(np.round(scale * values[:, k]) if form == "RAW" else values[:, k])
    head = [["Timestamp", *rows[0]], ["CAL", *rows[1]], ["mSecs", *rows[2]]]
    device = ["left foot"] * len(head[0])
    lines = ["\t".join(row) for row in (device, *head)]
    return _write(folder / "connect.dat.csv", lines + _lines(np.column_stack(parts), "\t"))


def noraxon(sensors: Sequence[Truth], folder: Path, comma: bool = False) -> Path:
    """An export of MR3: lines about the recording, accelerations in mG, angular velocities of the segments.

    Args:
        sensors: The sensors.
        folder: Where to write.
        comma: Whether numbers have a comma for a point.
    """
    names, parts = (
        ["time", "Activity", "Marker"],
        [sensors[0].time_s, 0 * sensors[0].time_s, 0 * sensors[0].time_s],
    )
    for one in sensors:
        part, side = one.name.split()
        names += [f"{part} Accel Sensor {axis} {side} (mG)" for axis in "XYZ"]
        names += [f"Noraxon MyoMotion-Segments-{part} {side}-Gyroscope-{axis} (deg/s)" for axis in "xyz"]
        names += [f"Noraxon MyoMotion-Segments-{part} {side}-Contact"]
        parts += [
            *(1e3 * one.force / GRAVITY_M_S2).T,
            *(DEGREES * one.turning).T,
            np.where(one.force[:, 2] > 9.0, 1000.0, 0.0),
        ]
    mark = ";" if comma else ","
    head = ["Measurement: walk", "Person: nobody", "Frequency: 100"]
    return _write(
        folder / "noraxon.csv",
        [*head, mark.join(names), *_lines(np.column_stack(parts), mark, comma)],
        "cp1252",
    )


def delsys(sensors: Sequence[Truth], folder: Path) -> Path:
    """An export of EMGworks: every channel with times of its own, muscles sampled faster than accelerations."""
    fast = np.arange(5 * SAMPLES) / (5.0 * RATE_HZ)
    names, columns = list[str](), list[Array]()

    def add(title: str, times: Array, values: Array) -> None:
        names.extend(["X[s]", title])
        for column in (times, values):
            columns.append(np.concatenate([column, np.full(len(fast) - len(column), np.nan)]))

    for k, one in enumerate(sensors, start=1):
        add(f"{one.name}: EMG {k} [V]", fast, 1e-4 * np.sin(fast))
        for word, unit, values in (
            ("ACC", "g", one.force / GRAVITY_M_S2), ("GYRO", "deg/s", DEGREES * one.turning), ("MAG", "uT", one.field),
        ):  # fmt: skip
            for axis, column in zip("XYZ", values.T, strict=True):
                add(f"{one.name}: {word}.{axis} {k} [{unit}]", one.time_s, column)
    return _write(folder / "delsys.csv", ['"' + '","'.join(names) + '"', *_lines(np.column_stack(columns))])


def x_imu3(sensors: Sequence[Truth], folder: Path) -> Path:
    """A session of x-IMU3s: a folder for each with Inertial.csv, Magnetometer.csv and Quaternion.csv."""
    for one in sensors:
        own, micros = folder / "session" / one.name, np.round(1e6 * one.time_s)
        inertial = np.column_stack([micros, DEGREES * one.turning, one.force / GRAVITY_M_S2])
        titles = ["Timestamp (us)", *_axes("Gyroscope {} (deg/s)"), *_axes("Accelerometer {} (g)")]
        _write(own / "Inertial.csv", [",".join(titles), *_lines(inertial)])
        titles = ["Timestamp (us)", *_axes("{} (a.u.)")]
        _write(own / "Magnetometer.csv", [",".join(titles), *_lines(np.column_stack([micros, one.field]))])
        titles = ["Timestamp (us)", "W", "X", "Y", "Z"]
        _write(own / "Quaternion.csv", [",".join(titles), *_lines(np.column_stack([micros, one.wxyz]))])
        _write(own / "Temperature.csv", ["Timestamp (us),Temperature (°C)", "0,25.0", "1000000,25.1"])
    return folder / "session"


def ngimu(one: Truth, folder: Path) -> Path:
    """A session of an NGIMU: sensors.csv and quaternion.csv."""
    own = folder / one.name
    words = "Gyroscope {} (deg/s)", "Accelerometer {} (g)", "Magnetometer {} (uT)"
    titles = ["Time (s)", *(title for word in words for title in _axes(word)), "Barometer (hPa)"]
    inertial = DEGREES * one.turning, one.force / GRAVITY_M_S2, one.field
    rows = np.column_stack([one.time_s, *inertial, 0 * one.time_s + 1013.0])
    _write(own / "sensors.csv", [",".join(titles), *_lines(rows)])
    _write(own / "quaternion.csv", ["Time (s),W,X,Y,Z", *_lines(np.column_stack([one.time_s, one.wxyz]))])
    return own


def phyphox(one: Truth, folder: Path, form: str = "folder") -> Path:
    """An export of phyphox: a table per sensor of the telephone, with commas, or semicolons and decimal commas.

    Args:
        one: The sensor.
        folder: Where to write.
        form: "folder", "semicolons" or "zip".
    """
    mark, comma = (";", True) if form == "semicolons" else (",", False)
    tables = {
        "Accelerometer": ("m/s^2", one.force),
        "Gyroscope": ("rad/s", one.turning),
        "Magnetometer": ("µT", one.field),
        "Linear Acceleration": ("m/s^2", one.free),
    }
    own = folder / one.name
    for name, (unit, values) in tables.items():
        titles = ["Time (s)", *(f"{axis} ({unit})" for axis in "XYZ")]
        lines = [mark.join(f'"{title}"' for title in titles)]
        _write(own / f"{name}.csv", lines + _lines(np.column_stack([one.time_s, values]), mark, comma))
    _write(own / "meta" / "time.csv", ['"event","experiment time"', '"START",0'])
    if form != "zip":
        return own
    archive = folder / f"{one.name}.zip"
    with zipfile.ZipFile(archive, "w") as file:
        for path in sorted(own.rglob("*.csv")):
            file.write(path, path.relative_to(own))
    return archive


SPELLINGS: dict[str, Callable[[str, str], str]] = {
    "acc_1": lambda kind, axis: f"{kind}_{'XYZ'.index(axis) + 1}",
    "accX": lambda kind, axis: f"{kind}{axis}",
    "ax": lambda kind, axis: f"{kind[0]}{axis.lower()}",
    "Acceleration X": lambda kind, axis: (
        {"acc": "Acceleration", "gyr": "Angular velocity", "mag": "Magnetic field"}[kind] + f" {axis}"
    ),
    "imu1.accel.x": lambda kind, axis: (
        f"imu1.{({'acc': 'accel', 'gyr': 'gyro', 'mag': 'mag'})[kind]}.{axis.lower()}"
    ),
}
"""Ways to name a column of a table of one's own."""


def plain(one: Truth, folder: Path, spelling: str) -> Path:
    """A table of one's own; it states no units.

    Args:
        one: The sensor.
        folder: Where to write.
        spelling: A key of :data:`SPELLINGS`.
    """
    name = SPELLINGS[spelling]
    titles = ["timestamp", *(name(kind, axis) for kind in ("acc", "gyr", "mag") for axis in "XYZ")]
    rows = np.column_stack(
        [1.7e12 + 1e3 * one.time_s, one.force / GRAVITY_M_S2, DEGREES * one.turning, one.field]
    )
    return _write(folder / f"{one.name}.csv", [",".join(titles), *_lines(rows)])
