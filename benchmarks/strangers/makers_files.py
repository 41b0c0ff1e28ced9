"""Files of makers of inertial sensors, read without options, and orientations from them beside VQF's.

Sensors turn and shake, as an arm does; their readings have noise and offsets. Writers of the documented forms print
them, so that the true orientation is known. The ratio to VQF's error depends on the draw of the offsets (.74 to 1.11 in
24 draws) and hardly on the form (two draws in six forms: at most .07 apart), so every form gets the same draws, and
their mean is judged. The files of ``strangers3`` follow. VQF is D. Laidig and T. Seel, Information Fusion 91 (2023)
187–204.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation, Slerp

from benchmarks.checks import Check, information, left_out
from benchmarks.inertial import makers, makers_binary
from benchmarks.inertial.makers import RATE_HZ, Truth
from benchmarks.needs import installed
from benchmarks.strangers import makers_recordings
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import MbkfError
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.orientation_error import orientation_error
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings

SECONDS, SETTLED_S = 40.0, 5.0
DRAWS = 8
"""Sensors by form."""

_NOISE = {"force": 0.05, "turning": 0.005, "field": 0.5}
_BIAS = {"force": 0.02, "turning": 0.01, "field": 0.3}
"""Standard deviations of samples and of lasting offsets, m/s², rad/s and µT; data sheets of gyroscopes state zero rates
within 0.5 to 3°/s."""

NO_VQF = "needs vqf: pip install '.[peers]'"

REFERENCED = (
    ("repoimu_two_row_header_TStick05_12s.csv", "RepoIMU, cameras"),
    ("xsens_sample_rate_header_100rows.txt", "early Xsens, the maker's filter"),
)
"""Files of ``strangers3`` with an orientation."""

PLAIN = (
    "apdm_motion_studio_60rows.csv",
    "ms_rounded_clock_163Hz.csv",
    "xio_short_walk_buffered_stamps_15s.csv",
)


def makers_file_rows(data: Path, out: Path) -> Iterator[Check]:
    """Every form: whether it is read, and its orientation's error over VQF's.

    Args:
        data: Folder of the public captures.
        out: Folder for the files that are made.
    """
    drawn = [moving_sensor("left_foot", seed) for seed in range(DRAWS)]
    for name, write in FORMS.items():
        folders = [out / name.replace(" ", "_").replace(",", "") / str(seed) for seed in range(DRAWS)]
        for folder in folders:
            folder.mkdir(parents=True, exist_ok=True)
        files = [write(true, folder) for true, folder in zip(drawn, folders, strict=True)]
        yield from _judged(f"made, {name}", list(zip(files, drawn, strict=True)))
    for file, title in REFERENCED:
        yield from _referenced(title, data / "strangers3" / file)
    for file in PLAIN:
        yield from _read(f"strangers3, {file}", data / "strangers3" / file)[1]


FORMS: dict[str, Callable[[Truth, Path], Path]] = {
    "APDM Motion Studio": lambda one, folder: makers.apdm_csv([one], folder),
    "APDM Mobility Lab": lambda one, folder: makers_binary.apdm([one], folder),
    "Xsens MT Manager": partial(makers.mt_manager, quaternion=False),
    "Xsens MT Manager without rate": makers_recordings.mt_manager_ticks,
    "Xsens DOT": makers.movella_dot,
    "Xsens MVN": lambda one, folder: makers_binary.mvnx([one], folder, own_turning=True),
    "early Xsens, counter and rate": makers.xsens_counter,
    "x-IMU with registers": makers_recordings.x_imu,
    "NGIMU": makers.ngimu,
    "x-IMU3": lambda one, folder: makers.x_imu3([one], folder),
    "x-io, stamps of packets": makers.packets,
    "RepoIMU": makers.repo_imu,
    "Axivity AX6": makers_recordings.cwa,
}
"""Writers of one sensor's file, by the name of the form."""


def moving_sensor(name: str, seed: int) -> Truth:
    """A sensor that turns at some rad/s and shakes at some m/s², after three seconds at rest, with noise and offsets.

    Args:
        name: Its name.
        seed: Of movement and noise.
    """
    rng = np.random.default_rng(seed)
    times = np.arange(round(SECONDS * RATE_HZ)) / RATE_HZ
    ramp = np.clip((times - 3.0) / 2.0, 0.0, 1.0)[:, None]

    def waves(low_hz: float, high_hz: float, size: float) -> Array:
        frequency, phase = rng.uniform(low_hz, high_hz, (3, 3)), rng.uniform(0.0, 2.0 * np.pi, (3, 3))
        return size * ramp * np.sin(2.0 * np.pi * frequency * times[:, None, None] + phase).mean(axis=1)

    turning = waves(0.2, 1.2, 5.0)
    steps = [Rotation.from_rotvec([0.3, -0.2, 0.1])]
    for rate in turning[1:]:  # each reading is the mean since the one before
        steps.append(steps[-1] * Rotation.from_rotvec(rate / RATE_HZ))
    turn = Rotation.concatenate(steps)
    readings = {
        "force": turn.inv().apply(waves(0.8, 2.0, 8.0) + np.array([0.0, 0.0, GRAVITY_M_S2])),
        "turning": turning,
        "field": turn.inv().apply(np.tile([0.0, 20.0, -40.0], (len(times), 1))),
    }
    read = {
        kind: values + rng.normal(0.0, _BIAS.get(kind, 0.0), 3) + rng.normal(0.0, _NOISE[kind], values.shape)
        for kind, values in readings.items()
    }
    return Truth(name, times, **read, turn=turn.as_quat())


def _read(name: str, path: Path) -> tuple[Sequence[ImuReadings], list[Check]]:
    """The sensors of a file, empty if it is refused, and the row that says which."""
    try:
        found = read_imu(path)
    except MbkfError:
        found = ()
    return found, [Check(f"{name}: read without options", float(bool(found)), 1.0, ">=")]


def _judged(name: str, files: Sequence[tuple[Path, Truth]]) -> Iterator[Check]:
    """Rows of a form's files whose true orientations (in ENU) are known."""
    errors = list[tuple[float, float]]()
    for path, true in files:
        found, rows = _read(name, path)
        if not errors:
            yield from rows
        if not found:
            return
        errors.append(_inclinations(found[0], true))
    own, theirs = np.transpose(errors)
    label = f"{name}: inclination of {len(errors)} draws, smoothed"
    yield information(label, float(np.degrees(own.mean())), "deg")
    yield _ratio(f"{label}, mean / VQF's", float(own.mean()), float(theirs.mean()))
    if installed("vqf"):
        yield information(f"{label}, largest of one draw / VQF's", float((own / theirs).max()))


def _inclinations(one: ImuReadings, true: Truth) -> tuple[float, float]:
    """Errors of the inclination by the smoother and by VQF, rad; NaN without VQF."""
    times = one.time_s - one.time_s[0]
    truth = Slerp(true.time_s, Rotation.from_quat(true.turn))(np.minimum(times, true.time_s[-1])).as_quat()
    settled = times > SETTLED_S
    own = orientation_error(_own(one), truth, settled).inclination
    theirs = orientation_error(_vqf(one), truth, settled).inclination if installed("vqf") else np.nan
    return own, theirs


def _referenced(title: str, path: Path) -> Iterator[Check]:
    """Rows of a file with an orientation in a frame of its own: after the best turns of world and sensor."""
    found, rows = _read(title, path)
    yield from rows
    if not found or found[0].orientation is None:
        return
    one, reference = found[0], found[0].orientation
    own = _after_alignment(_own(one), reference)
    yield information(f"{title}: error, smoothed", float(np.degrees(own)), "deg")
    theirs = _after_alignment(_vqf(one), reference) if installed("vqf") else np.nan
    yield _ratio(f"{title}: error / VQF's", own, theirs)


def _ratio(name: str, own: float, theirs: float) -> Check:
    """The ratio to VQF's error; left out without VQF."""
    return Check(name, float(own / theirs), 1.0, "<=") if installed("vqf") else left_out(name, NO_VQF)


def _own(one: ImuReadings) -> Array:
    """(T, 4) the smoother's orientation in ENU."""
    return orientations([one], frame="ENU", settings=OrientSettings("smooth"))[0].quaternion


def _vqf(one: ImuReadings) -> Array:
    """(T, 4) VQF's offline orientation in ENU; missing samples, which it does not take, are held."""
    from vqf import offlineVQF

    gyro, force, field = (
        None if values is None else _held(values)
        for values in (one.angular_velocity_rad_s, one.specific_force_mps2, one.magnetic_field)
    )
    found = offlineVQF(gyro, force, field, 1.0 / one.rate_hz)
    key = "quat6D" if field is None else "quat9D"
    return np.asarray(found[key][:, [1, 2, 3, 0]])


def _held(values: Array) -> Array:
    """(T, 3) values, where missing those of the last sample."""
    last = np.maximum.accumulate(np.where(np.isfinite(values).all(axis=1), np.arange(len(values)), 0))
    return np.ascontiguousarray(values[last])


def _after_alignment(turn: Array, reference: Array) -> float:
    """Root mean square angle between orientations after the turns of world and sensor that make it least, rad."""
    there = np.isfinite(turn).all(axis=1) & np.isfinite(reference).all(axis=1)
    own, other = Rotation.from_quat(turn[there]), Rotation.from_quat(reference[there])

    def off(turns: Array) -> Array:
        fitted = Rotation.from_rotvec(turns[:3]) * other * Rotation.from_rotvec(turns[3:])
        return np.asarray((own * fitted.inv()).as_rotvec().ravel())

    rng = np.random.default_rng(0)
    starts = [np.zeros(6), *rng.normal(0.0, 1.5, (8, 6))]
    best = min((least_squares(off, start) for start in starts), key=lambda fit: float(fit.cost))
    return float(np.sqrt((best.fun**2).sum() / there.sum()))
