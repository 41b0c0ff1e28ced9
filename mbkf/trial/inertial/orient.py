"""From files of inertial readings to orientations: checks, resampling, filter, and error against a reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.checks import problems, refuse_fatal
from mbkf.imu.field_disturbance import field_remarks
from mbkf.imu.frames import FRAMES, change_frame
from mbkf.imu.orientation import METHODS, Orientation, OrientSettings, orientations
from mbkf.imu.orientation_difference import orientation_difference
from mbkf.imu.orientation_error import OrientationError, orientation_error
from mbkf.io.imu.readings import ImuReadings, on_regular_grid
from mbkf.numerics.threads import single_threaded
from mbkf.trial.inertial.stated_orientation import OWN, stated_orientations

COMPARED = "compared"
"""Word for a start with the first orientation of the file that is compared with."""

UNIT_WITHIN = 0.01
"""Deviation of a start's length from 1 that is rounding; more is a mistake."""


@dataclass(frozen=True)
class OrientResult:
    """Orientations of a recording.

    Attributes:
        courses: One per sensor.
        compared: Those of the second filter, or of the file that they are compared with; empty without one.
        errors: Per sensor that brings a reference with a known world, its name and error.
        moving_errors: The same over the movement phases that its file marks.
        warnings: Problems of the readings, each with its likely remedy.
    """

    courses: tuple[Orientation, ...]
    compared: tuple[Orientation, ...]
    errors: tuple[tuple[str, OrientationError], ...]
    moving_errors: tuple[tuple[str, OrientationError], ...]
    warnings: tuple[str, ...]


def prepared(
    readings: Sequence[ImuReadings], only: Sequence[str] = ()
) -> tuple[tuple[ImuReadings, ...], tuple[str, ...]]:
    """The sensors wanted, checked and on a regular grid, and the warnings.

    Raises:
        UnknownName: The sensor does not exist.
        InvalidInput: Something is wrong that would make results wrong.
    """
    names = [one.name for one in readings]
    for name in only:
        if name not in names:
            raise UnknownName("sensor", name, names)
    chosen = [one for one in readings if not only or one.name in only]
    if len({one.name for one in chosen}) < len(chosen):
        raise InvalidInput("two sensors have the same name; give them different names")
    warnings = refuse_fatal(problems(chosen))
    return tuple(on_regular_grid(one) for one in chosen), warnings


def orient(
    readings: Sequence[ImuReadings],
    *,
    frame: str,
    settings: OrientSettings | None = None,
    compare: str | Path | None = None,
    start: Sequence[float] | str | None = None,
    only: Sequence[str] = (),
    progress: StageCallback | None = None,
) -> OrientResult:
    """Orientation of every sensor, by one filter or two, or beside those of a file.

    Args:
        readings: As read.
        frame: World frame of the result: ENU, NED or NWU.
        settings: Filter and its parameters.
        compare: Name of a second filter, "file" for the orientations in the sensors' own file, or another file with
            quaternions (:func:`mbkf.trial.inertial.stated_orientation.stated_orientations`).
        start: (4,) orientation x, y, z, w of one sensor at its first sample in ``frame``, or :data:`COMPARED`: the
            first that the file states; by default that of a sensor at rest.
        only: Names of the sensors wanted, all when empty.
        progress: Called as samples are done.

    Raises:
        FileFormatError: The file of orientations is missing, or without any.
        InvalidInput: The readings are not plausible, or a start is not known; the message gives the remedy.
        UnknownName: Unknown sensor, frame or filter.
    """
    chosen = settings or OrientSettings()
    sensors, warnings = prepared(readings, only)
    by_filter = compare in METHODS
    stated, notes = _stated(sensors, frame, None if by_filter else compare)
    begins = _starts(sensors, start, stated)
    with single_threaded():
        courses = orientations(sensors, frame=frame, settings=chosen, start=begins, progress=progress)
        second = replace(chosen, method=str(compare)) if by_filter else None
        compared = (
            stated if second is None else orientations(sensors, frame=frame, settings=second, start=begins)
        )
    errors, moving = [], []
    for one, course in zip(sensors, courses, strict=True):
        world = [name for name in FRAMES if name in one.frame]
        if one.orientation is not None and len(world) == 1:
            reference = change_frame(one.orientation, world[0], frame)
            errors.append((one.name, orientation_error(course.quaternion, reference)))
            if one.moving is not None:
                moving.append((one.name, orientation_error(course.quaternion, reference, one.moving)))
    disturbances = [
        remark
        for one, course in zip(sensors, courses, strict=True)
        if chosen.magnetometer
        for remark in field_remarks(one, change_frame(course.quaternion, frame, "NWU"))
    ]
    return OrientResult(courses, compared, tuple(errors), tuple(moving), (*warnings, *notes, *disturbances))


def _stated(
    sensors: Sequence[ImuReadings], frame: str, source: str | Path | None
) -> tuple[tuple[Orientation, ...], tuple[str, ...]]:
    """The orientations of a file, and notes; neither without a file."""
    if source is None:
        return (), ()
    if source != OWN and not Path(source).exists():
        raise UnknownName("filter or file", str(source), (*METHODS, OWN), "--compare")
    return stated_orientations(sensors, frame, source)


def _starts(
    sensors: Sequence[ImuReadings], start: Sequence[float] | str | None, stated: Sequence[Orientation]
) -> Array | None:
    """(N, 4) unit quaternions of the sensors' first samples; None where they follow from the readings."""
    if start is None:
        return None
    if isinstance(start, str):
        if start != COMPARED or not stated:
            raise InvalidInput(
                f"a start '{start}' needs orientations of a file; give --compare file or --compare FILE with it"
            )
        return np.array([_first(one) for one in stated])
    turn = np.asarray(start, dtype=float)
    if len(sensors) > 1:
        names = ", ".join(one.name for one in sensors)
        raise InvalidInput(f"one start for {len(sensors)} sensors ({names}); choose one with --sensor")
    size = float(np.linalg.norm(turn))
    if turn.shape != (4,) or not abs(size - 1.0) < UNIT_WITHIN:
        raise InvalidInput(f"a start is a unit quaternion of four numbers; these have the length {size:.3g}")
    begin: Array = turn[None] / size
    return begin


def _first(stated: Orientation) -> Array:
    first: Array = stated.quaternion[0]
    if not np.isfinite(first).all():
        raise InvalidInput(
            f"sensor {stated.name}: {stated.method} states no orientation at its first sample; give --initial W,X,Y,Z"
        )
    return first


def orientation_summary(result: OrientResult, settings: OrientSettings) -> dict[str, object]:
    """Plain data for ``orientation.json``; angles in degrees."""
    errors, moving = dict(result.errors), dict(result.moving_errors)
    sensors = []
    for k, course in enumerate(result.courses):
        error = errors.get(course.name)
        row: dict[str, object] = {
            "name": course.name,
            "samples": len(course.time_s),
            "missing_fraction": float(np.isnan(course.quaternion).any(axis=1).mean()),
            "gyro_bias_deg_s": np.degrees(course.gyro_bias_rad_s[-1]).tolist(),
            "sd_deg": None if course.sd_rad is None else np.degrees(course.sd_rad.mean(axis=0)).tolist(),
            "error_deg": None if error is None else _degrees(error),
            "error_moving_deg": _degrees(moving[course.name]) if course.name in moving else None,
        }
        if result.compared:
            apart = orientation_difference(course.quaternion, result.compared[k].quaternion)
            parts = {
                "total": apart.angle_rad, "heading": apart.heading_rad, "inclination": apart.inclination_rad
            }  # fmt: skip
            row["difference_rms_deg"] = {
                name: float(np.degrees(np.sqrt(np.nanmean(one**2)))) for name, one in parts.items()
            }
            mean = np.nanmean(np.abs(apart.components), axis=0).tolist()
            row["difference_mean_quaternion"] = dict(zip(("x", "y", "z", "w"), mean, strict=True))
        sensors.append(row)
    first = result.courses[0]
    return {
        "method": first.method,
        "compared_with": result.compared[0].method if result.compared else None,
        "frame": first.frame,
        "initial": {one.name: one.quaternion[0].tolist() for one in result.courses},
        "sensors": sensors,
        "warnings": list(result.warnings),
        "settings": asdict(settings),
    }


def _degrees(error: OrientationError) -> dict[str, float]:
    return {
        "total": float(np.degrees(error.total)),
        "heading": float(np.degrees(error.heading)),
        "inclination": float(np.degrees(error.inclination)),
        "samples": error.samples,
    }
