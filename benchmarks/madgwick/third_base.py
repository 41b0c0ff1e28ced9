"""The source's third data base: Technaid exports as CSV, through the commands that a user of such sensors would run.

Its recordings are not public, and its .capp and .capq files are binary (no description was found; the source converted
them itself). The tables are made here, as it describes them: names padded with blanks, no times, no units, quaternions
in a table of their own, w first, from a Kalman filter in the sensor. That filter is not described; the textbook one
stands for it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.commands import mbkf
from benchmarks.madgwick.as_printed import madgwick_as_printed
from benchmarks.madgwick.plain_ekf import PlainSettings, plain_ekf
from benchmarks.madgwick.scenes import (
    FOOT,
    RATE_HZ,
    SHOWN_ON,
    SITTING,
    STANDING,
    THIGH,
    WALKING,
    rms_deg,
    scene,
    truth_of,
)
from mbkf.conventions import Array
from mbkf.imu.orientation_difference import orientation_difference
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings

RECORDINGS = ((WALKING, THIGH), (WALKING, FOOT), (SITTING, THIGH), (STANDING, THIGH))
"""Those of its figures 32 to 39."""

STATED = ("--units", "acc=m/s2,gyr=rad/s,mag=uT", "--rate", f"{RATE_HZ:g}")
FIRST_SWEEP = ("0.1:1:10", "0.1:1:10")
SECOND_SWEEP = ("0.3:0.4:11", "0.01:0.1:10")


@dataclass(frozen=True)
class Sweep:
    """A sweep by `mbkf imu tune`: the best ``beta`` and ``zeta``, their ``error_deg``, ``trials`` (β, ζ, error deg)."""

    beta: float
    zeta: float
    error_deg: float
    trials: list[tuple[float, float, float]]


@dataclass(frozen=True)
class Compared:
    """Madgwick's filter against the sensor's own quaternions on one recording.

    Attributes:
        movement, sensor: The recording.
        table: (T, 15) columns of ``NAME_compare.csv``.
        mean_qw: Mean difference of q_w, as the source states it.
        rms_deg: Root mean square angle between the two.
        madgwick_deg, own_deg: Error of either against the truth.
    """

    movement: str
    sensor: str
    table: Array
    mean_qw: float
    rms_deg: float
    madgwick_deg: float
    own_deg: float


@dataclass(frozen=True)
class ThirdBase:
    """Results.

    Attributes:
        read: Largest difference between readings written and read again, SI units.
        compared: The source's β beside the sensor's own quaternions, by recording.
        first, second, wide: The source's two sweeps, and one over smaller gains.
        letter: Mean difference of q_w with ζ 0.01 and 0.1 by Madgwick eq. 34 as printed, β 0.33, the walking thigh.
    """

    read: float
    compared: list[Compared]
    first: Sweep
    second: Sweep
    wide: Sweep
    letter: tuple[float, float]


def measure_third_base(folder: Path, direction_sd: float) -> ThirdBase:
    """Writes the tables of a person, runs the commands on them and reads their results.

    Args:
        folder: For the tables.
        direction_sd: Setting of the sensor's own filter.
    """
    person, compared, read = SHOWN_ON[0], [], 0.0
    for movement, name in RECORDINGS:
        one = scene(person, movement).sensor(name)
        own = plain_ekf(one, PlainSettings(direction_sd), truth_of(one)[0])
        stem = f"{movement.split()[0]}_{name}"
        physical, quaternions = folder / f"{stem}_capp.csv", folder / f"{stem}_capq.csv"
        write_technaid(one, own, physical, quaternions)
        read = max(read, _read_back(one, physical))
        compared.append(_compared(one, own, movement, physical, quaternions, folder / stem))
    physical, quaternions = folder / f"walking_{THIGH}_capp.csv", folder / f"walking_{THIGH}_capq.csv"
    first, second, wide = (
        _swept(physical, quaternions, *grid, folder)
        for grid in (FIRST_SWEEP, SECOND_SWEEP, ("0.01:0.4:14", "0:0.1:3"))
    )
    return ThirdBase(read, compared, first, second, wide, _letter(person, direction_sd))


def _letter(person: int, direction_sd: float) -> tuple[float, float]:
    one = scene(person, WALKING).sensor(THIGH)
    own = plain_ekf(one, PlainSettings(direction_sd), truth_of(one)[0])
    found = []
    for zeta in (0.01, 0.1):
        course = madgwick_as_printed(one, 0.33, zeta, own[0])
        found.append(float(np.mean(np.abs(orientation_difference(own, course).components[:, 3]))))
    return found[0], found[1]


def write_technaid(one: ImuReadings, own: Array, physical: Path, quaternions: Path) -> None:
    """Writes both tables of a sensor.

    Args:
        one: The sensor.
        own: (T, 4) quaternions x, y, z, w of its own filter.
        physical: File of the physical quantities.
        quaternions: File of the quaternions.
    """
    assert one.magnetic_field is not None
    names = ",".join(f" {kind} {axis} " for kind in ("Acc", "Gyro", "Mag") for axis in "XYZ")
    table = np.hstack([one.specific_force_mps2, one.angular_velocity_rad_s, one.magnetic_field])
    np.savetxt(physical, table, "%.9g", ",", header=names, comments="")
    np.savetxt(quaternions, own[:, [3, 0, 1, 2]], "%.9g", ",", header=" qW , qX , qY , qZ ", comments="")


def _read_back(one: ImuReadings, physical: Path) -> float:
    (found,) = read_imu(physical, units={"acc": "m/s2", "gyr": "rad/s", "mag": "uT"}, rate_hz=RATE_HZ)
    assert one.magnetic_field is not None and found.magnetic_field is not None
    return max(
        float(np.abs(found.specific_force_mps2 - one.specific_force_mps2).max()),
        float(np.abs(found.angular_velocity_rad_s - one.angular_velocity_rad_s).max()),
        float(np.abs(found.magnetic_field - one.magnetic_field).max()),
    )


def _compared(
    one: ImuReadings, own: Array, movement: str, physical: Path, quaternions: Path, out: Path
) -> Compared:
    gains = ("--filter", "madgwick", "--beta", "0.35", "--frame", "NWU")
    beside = ("--compare", quaternions, "--initial", "compared")
    mbkf("imu", "orient", physical, *STATED, *gains, *beside, "--out", out)
    table = np.genfromtxt(out / f"{physical.stem}_compare.csv", delimiter=",", skip_header=2)
    row = json.loads((out / "orientation.json").read_text(encoding="utf-8"))["sensors"][0]
    course = np.genfromtxt(out / f"{physical.stem}.csv", delimiter=",", skip_header=2)[:, 1:5]
    return Compared(
        movement,
        one.name,
        table,
        row["difference_mean_quaternion"]["w"],
        row["difference_rms_deg"]["total"],
        rms_deg([course], [one]),
        rms_deg([own], [one]),
    )


def _swept(physical: Path, quaternions: Path, betas: str, zetas: str, folder: Path) -> Sweep:
    against = ("--against", quaternions, "--initial", "compared", "--frame", "NWU")
    file = folder / "gains.json"
    mbkf(
        "imu", "tune", physical, *STATED, "--search", *against, "--betas", betas, "--zetas", zetas, "--out", file
    )  # fmt: skip
    row = json.loads(file.read_text(encoding="utf-8"))["sensors"][0]
    trials = [(one["beta"], one["zeta"], one["error_deg"]) for one in row["trials"]]
    return Sweep(row["beta"], row["zeta"], row["error_deg"], trials)
