"""Every file form of inertial sensors, written from one truth by its description, read back as equal arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.inertial import makers, makers_binary
from benchmarks.inertial.makers import SPELLINGS, Truth, truth
from mbkf.io.imu.files import read_imu, read_imu_session
from mbkf.io.imu.readings import ImuReadings

EXACT, STAMPS, SINGLE = 1e-9, 2e-5, 1e-5
"""Differences, relative to what sensors read: of numbers written whole; of readings interpolated at times that are
counted in whole steps since 1970; of numbers of 32 bits."""

PLAIN = {"acc": "g", "gyr": "deg/s", "mag": "uT"}


@dataclass(frozen=True)
class Form:
    """A form of file.

    Attributes:
        write: Writes sensors to a folder and returns what is to be read.
        sensors: What was written.
        names: Names under which sensors are to be found; those of the truth by default.
        without: Quantities that the form does not hold: "field", "turn".
        tolerance: Largest difference relative to the quantity's size.
        units: Units that its reader asks for.
        lost: Samples that the form lost, which are missing.
    """

    write: Callable[[Path], Path | Sequence[Path]]
    sensors: Sequence[Truth]
    names: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    tolerance: float = EXACT
    units: dict[str, str] = field(default_factory=dict)
    lost: tuple[int, ...] = ()


def forms() -> dict[str, Form]:
    """Every form by its name."""
    left, right = truth("left_foot", 1), truth("right_shank", 2)
    two = (left, right)
    suit = (truth("Pelvis", 3), truth("RightUpperLeg", 4), truth("LeftFoot", 5))
    sided = (truth("Foot LT", 6), truth("Shank RT", 7))
    late = truth("right_shank", 2, start_s=0.5, samples=makers.SAMPLES - 80)
    made = {
        "Xsens MVN (.mvnx)": Form(partial(makers_binary.mvnx, suit), suit),
        "Xsens MVN with sensors' rates": Form(partial(makers_binary.mvnx, suit, own_turning=True), suit),
        "MT Manager, tabs": Form(partial(makers.mt_manager, left), (left,), ("MT_0001-000_left_foot",), lost=(200,)),
        "MT Manager, commas": Form(
            partial(makers.mt_manager, left, mark=",", quaternion=False), (left,), ("MT_0001-000_left_foot",),
            without=("turn",), lost=(200,),
        ),
        "MT software, counter and rate": Form(partial(makers.xsens_counter, left), (left,)),
        "Movella DOT": Form(partial(makers.movella_dot, left), (left,), without=("turn",)),
        "Movella DOT, quaternion and free acceleration": Form(
            partial(makers.movella_dot, left, orientation_only=True), (left,), without=("field", "turning")
        ),
        "APDM Mobility Lab (.h5)": Form(partial(makers_binary.apdm, two), two),
        "APDM Motion Studio (.h5)": Form(partial(makers_binary.apdm, two, version=3), two),
        "APDM Motion Studio (.csv)": Form(partial(makers.apdm_csv, two), two),
        "RepoIMU, names in two rows": Form(partial(makers.repo_imu, left), (left,), ("IMU",)),
        "table with stamps of packets": Form(partial(makers.packets, left), (left,), without=("turn",)),
        "Shimmer Consensys": Form(partial(makers.shimmer, left), (left,), ("Shimmer_6A92",), without=("turn",)),
        "ShimmerConnect": Form(partial(makers.shimmer_connect, left), (left,), ("left foot",), without=("turn",)),
        "Noraxon MR3": Form(partial(makers.noraxon, sided), sided, without=("field", "turn")),
        "Noraxon MR3, decimal commas": Form(
            partial(makers.noraxon, sided, comma=True), sided, without=("field", "turn")
        ),
        "Delsys EMGworks": Form(partial(makers.delsys, sided), sided, ("Foot LT 1", "Shank RT 2"), without=("turn",)),
        "x-io x-IMU3": Form(partial(makers.x_imu3, two), two),
        "x-io NGIMU": Form(partial(makers.ngimu, left), (left,)),
        "phyphox, folder": Form(partial(makers.phyphox, left), (left,), without=("turn",)),
        "phyphox, semicolons": Form(partial(makers.phyphox, left, form="semicolons"), (left,), without=("turn",)),
        "phyphox, zip": Form(partial(makers.phyphox, left, form="zip"), (left,), without=("turn",)),
        "XDF": Form(partial(makers_binary.xdf, two), two, without=("turn",)),
        "C3D analog channels": Form(
            partial(makers_binary.c3d, two), two, without=("field", "turn"), tolerance=SINGLE
        ),
        "several files, stamps since 1970, one later": Form(
            lambda folder: [makers.plain(one, folder, "accX") for one in (left, late)], (left, late),
            without=("turn",), tolerance=STAMPS, units=PLAIN,
        ),
    }  # fmt: skip
    for spelling in SPELLINGS:
        names = ("imu1",) if spelling.startswith("imu1") else ()
        made[f"table with {spelling}"] = Form(
            partial(makers.plain, left, spelling=spelling), (left,), names, without=("turn",), units=PLAIN
        )
    return made


def difference(form: Form, folder: Path) -> float:
    """Largest difference between what was written and what is read, relative to the tolerance.

    It is infinite where a sensor, a quantity or a sample is missing or has another name.
    """
    made = form.write(folder)
    units = form.units or None
    found = (
        read_imu_session(made, units=units)
        if isinstance(made, list)
        else read_imu(Path(str(made)), units=units)
    )
    names = form.names or tuple(one.name for one in form.sensors)
    if [one.name for one in found] != list(names):
        return float("inf")
    first = max(float(one.time_s[0]) for one in form.sensors)
    last = min(float(one.time_s[-1]) for one in form.sensors)
    worst = 0.0
    for one, own in zip(found, form.sensors, strict=True):
        kept = (own.time_s > first - 1e-6) & (own.time_s < last + 1e-6)
        worst = max(worst, _difference(form, one, own, kept))
    return worst / form.tolerance


def _difference(form: Form, one: ImuReadings, own: Truth, kept: np.ndarray) -> float:
    wanted = {
        "force": one.specific_force_mps2,
        "turning": one.angular_velocity_rad_s,
        "field": one.magnetic_field,
    }
    worst = 0.0
    for name, values in {**wanted, "turn": one.orientation}.items():
        if name in form.without:
            if name != "turn" and values is not None and not np.isnan(values).all():
                return float("inf")
            continue
        true = np.array(getattr(own, name)[kept])
        true[list(form.lost)] = np.nan
        if values is None or values.shape != true.shape or (np.isnan(values) != np.isnan(true)).any():
            return float("inf")
        if name == "turn":
            true *= np.sign(np.nansum(true * values, axis=1, keepdims=True))
        worst = max(worst, float(np.nanmax(np.abs(values - true)) / np.nanmax(np.abs(true))))
    steps = np.diff(one.time_s) - 1.0 / makers.RATE_HZ
    return max(worst, 1e-3 * form.tolerance * float(np.abs(steps).max()) / 1e-6)


def rows(context: Context) -> list[Check]:  # noqa: ARG001  (nothing is read but what is written here)
    """A row per form: its largest difference, relative to the tolerance."""
    checks = []
    for name, form in forms().items():
        with TemporaryDirectory() as folder:
            checks.append(Check(f"file read as written: {name}", difference(form, Path(folder)), 1.0, "<="))
    return checks
