"""From files of inertial readings to orientations: checks, resampling, filter, and error against a reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.checks import problems, refuse_fatal
from mbkf.imu.field_disturbance import field_remarks
from mbkf.imu.frames import FRAMES, change_frame
from mbkf.imu.orientation import Orientation, OrientSettings, orientations
from mbkf.imu.orientation_error import OrientationError, error_angles, orientation_error
from mbkf.io.imu.readings import ImuReadings, on_regular_grid
from mbkf.numerics.threads import single_threaded


@dataclass(frozen=True)
class OrientResult:
    """Orientations of a recording.

    Attributes:
        courses: One per sensor.
        compared: The same by the second filter, empty without one.
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
    compare: str | None = None,
    only: Sequence[str] = (),
    progress: StageCallback | None = None,
) -> OrientResult:
    """Orientation of every sensor, by one filter or two.

    Args:
        readings: As read.
        frame: World frame of the result: ENU, NED or NWU.
        settings: Filter and its parameters.
        compare: Name of a second filter.
        only: Names of the sensors wanted, all when empty.
        progress: Called as samples are done.

    Raises:
        InvalidInput: The readings are not plausible; the message gives the remedy.
        UnknownName: Unknown sensor, frame or filter.
    """
    chosen = settings or OrientSettings()
    sensors, warnings = prepared(readings, only)
    with single_threaded():
        courses = orientations(sensors, frame=frame, settings=chosen, progress=progress)
        second = None if compare is None else replace(chosen, method=compare)
        compared = () if second is None else orientations(sensors, frame=frame, settings=second)
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
    return OrientResult(courses, compared, tuple(errors), tuple(moving), (*warnings, *disturbances))


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
            total, heading, inclination = error_angles(result.compared[k].quaternion, course.quaternion)
            row["difference_rms_deg"] = {
                name: float(np.degrees(np.sqrt(np.nanmean(one**2))))
                for name, one in (("total", total), ("heading", heading), ("inclination", inclination))
            }
        sensors.append(row)
    first = result.courses[0]
    return {
        "method": first.method,
        "compared_with": result.compared[0].method if result.compared else None,
        "frame": first.frame,
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
