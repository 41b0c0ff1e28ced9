"""Stride lengths and foot paths from sensors on the feet.

Measures every stride of one or two feet (length, duration, speed, height) and the path of the foot, from the
accelerometer and gyroscope of a sensor worn on it.

Methods:
  smoother     Kalman filter with zero-velocity updates and backward smoother (default)
  filter       the same without the smoother, from earlier readings only
  key-points   stable windows, gravity carried between them, two integrations; its windows of 0.2 s hardly fit into
               the rests of ordinary walking, and on single and slow steps it errs more than the smoother, too;
               --as-printed runs it by the letter

A foot must rest on the ground for a moment in every stride, and should stand still for a second at the start. A capture
with a sensor on each foot gives both feet in one frame, with step times and cadence.

Examples:
  mbkf imu stride feet.csv --out strides
  mbkf imu stride left.csv right.csv --units acc=g,gyr=deg/s --rate 100 --out strides
  mbkf imu stride body.csv --sensor left_foot --sensor right_foot --level --out strides
  mbkf imu stride step.csv --method key-points --weights 0.2,0.4,0.4 --out step
  mbkf imu stride step.csv --method key-points --as-printed --out printed

Writes strides.csv, trajectory.csv, summary.json and feet.png, a picture with the rests marked (needs matplotlib, the
extra 'figures').
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbkf.cli.imu import add_reading_options, chosen, read
from mbkf.cli.options import add_out

if TYPE_CHECKING:
    from mbkf.io.imu.readings import ImuReadings
    from mbkf.trial.inertial.stride import StrideMeasurement, StrideSettings

PICTURE_FILE = "feet.png"
_MOST_FEET = 2


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("files", metavar="FILE", nargs="+", help="readings of one or several sensors")
    add_reading_options(parser)
    parser.add_argument(
        "--method", choices=("smoother", "filter", "key-points"), default="smoother", help="see above"
    )
    parser.add_argument(
        "--level",
        action="store_true",
        help="the ground is level: every rest has one height (not for key points)",
    )
    parser.add_argument(
        "--weights",
        metavar="A,B,C",
        help="key points: weights of spread, change and rotation (0.1,0.45,0.45)",
    )
    parser.add_argument("--threshold", type=float, metavar="E", help="key points: bound of the stability (1)")
    parser.add_argument(
        "--window", type=int, metavar="N", help="key points: samples per window at 50 Hz (10)"
    )
    parser.add_argument(
        "--as-printed",
        action="store_true",
        help="key points: the paper by the letter: weights 0.2,0.4,0.4, the gyroscope's bias from the first second, "
        "and velocities that rests do not set to zero",
    )
    add_out(parser, "DIR", "folder to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Measures the strides, writes the folder and prints a table."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder, remove_file
    from mbkf.io.atomic_folder import replacing_folder
    from mbkf.trial.inertial.stride import measure_strides
    from mbkf.trial.inertial.stride_folder import (
        STRIDES_FILE,
        SUMMARY_FILE,
        TRAJECTORY_FILE,
        write_stride_files,
    )

    folder = check_folder(args.out, (STRIDES_FILE, TRAJECTORY_FILE, SUMMARY_FILE, PICTURE_FILE))
    settings, readings = _settings(args), _feet(args)
    with stages() as report:
        measured = measure_strides(readings, settings, progress=report)
    with replacing_folder(folder, last=SUMMARY_FILE) as partial:
        write_stride_files(measured, partial)
        drawn = _draw(measured, partial / PICTURE_FILE)
    if not drawn:
        remove_file(folder / PICTURE_FILE)  # an earlier run's picture shows other strides
    _print(measured, str(args.out))
    return 0


def _draw(measured: StrideMeasurement, path: Path) -> bool:
    from mbkf.errors import MissingDependency

    try:
        from mbkf.viz.imu.foot_path import write_foot_path
    except MissingDependency as missing:
        print(f"note: {path.name} was not drawn. {missing}", file=sys.stderr)
        return False
    write_foot_path(measured, path)
    return True


def _settings(args: argparse.Namespace) -> StrideSettings:
    from dataclasses import replace

    from mbkf.errors import InvalidInput
    from mbkf.imu.foot_filter import LEVEL_M, FootFilterSettings
    from mbkf.imu.key_points import KeyPointSettings, as_printed
    from mbkf.trial.inertial.stride import StrideSettings

    own = {name: getattr(args, name) for name in ("threshold", "window") if getattr(args, name) is not None}
    if args.weights is not None:
        try:
            spread, change, rotation = (float(word) for word in args.weights.split(","))
        except ValueError as error:
            raise InvalidInput(
                f"--weights {args.weights}: give three numbers, as in 0.1,0.45,0.45"
            ) from error
        own["weights"] = spread, change, rotation
    own_options = [*own, *(["as-printed"] if args.as_printed else [])]
    if own_options and args.method != "key-points":
        raise InvalidInput(f"--{own_options[0]} belongs to --method key-points")
    if args.level and args.method == "key-points":
        raise InvalidInput("--level belongs to the Kalman filter; leave it out with --method key-points")
    kalman = FootFilterSettings(level_m=LEVEL_M if args.level else None)
    key_points = replace(as_printed() if args.as_printed else KeyPointSettings(), **own)
    return StrideSettings(method=args.method, kalman=kalman, key_points=key_points)


def _feet(args: argparse.Namespace) -> list[ImuReadings]:
    """The readings of one or two sensors, in the order of ``--sensor``.

    Raises:
        InvalidInput: The files hold more, and ``--sensor`` does not choose.
    """
    from mbkf.errors import InvalidInput

    found = chosen(read(args.files, args), args.sensor)
    if not 1 <= len(found) <= _MOST_FEET:
        raise InvalidInput(
            f"{len(found)} sensors: {', '.join(one.name for one in found) or 'none'}; name those of one or two feet "
            "with --sensor"
        )
    return sorted(found, key=lambda one: args.sensor.index(one.name)) if args.sensor else found


def _print(measured: StrideMeasurement, out: str) -> None:
    from mbkf.cli.tables import table, terminal
    from mbkf.trial.inertial.stride import STRAIGHT_DEG, stride_summary

    summary: dict[str, Any] = stride_summary(measured)
    title = f"{out}: {summary['method_meaning']}"
    shown = table(title, "foot", "strides", "length m", "duration s", "speed m/s", "walked m")
    for name, numbers in summary["feet"].items():
        spread = [
            _spread(numbers[f"{key}_mean"], numbers[f"{key}_sd"])
            for key in ("length_m", "duration_s", "speed_m_s")
        ]
        shown.add_row(name, str(numbers["strides"]), *spread, f"{numbers['distance_m']:.2f}")
    terminal().print(shown)
    print(f"mean ± spread over strides that turn by less than {STRAIGHT_DEG:g}°")
    both = summary.get("both_feet")
    if both and both["step_time_s_median"]:
        print(
            f"both feet: {both['steps']} steps, {both['cadence_steps_per_min']:.0f} per minute, "
            f"step time {both['step_time_s_median']:.2f} s"
        )
    for warning in summary["warnings"]:
        print(f"warning: {warning}")


def _spread(mean: float | None, sd: float | None) -> str:
    if mean is None:
        return "–"
    return f"{mean:.2f}" if sd is None else f"{mean:.2f} ± {sd:.2f}"
