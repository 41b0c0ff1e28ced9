"""`mbkf imu stride`: strides and paths of feet from sensors worn on them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mbkf.io.imu.readings import ImuReadings
    from mbkf.trial.inertial.stride import StrideMeasurement, StrideSettings

PICTURE_FILE = "feet.png"
_MOST_FEET = 2

_EPILOG = """\
methods:
  smoother     Kalman filter with zero-velocity updates and backward smoother (default)
  filter       the same without the smoother, from earlier readings only
  key-points   stable windows, gravity carried between them, two integrations; its windows of 0.2 s hardly fit into
               the rests of ordinary walking, so it is for slow or single steps
A foot must rest on the ground for a moment in every stride, and should stand still for a second at the start. A
capture with a sensor on each foot gives both feet in one frame, with step times and cadence.

examples:
  mbkf imu stride feet.csv --out strides
  mbkf imu stride left.csv right.csv --units acc=g,gyr=deg/s --rate 100 --out strides
  mbkf imu stride body.csv --sensor left_foot --sensor right_foot --level --out strides
  mbkf imu stride step.csv --method key-points --weights 0.2,0.4,0.4 --out step

writes to DIR: strides.csv, trajectory.csv, summary.json and feet.png, a picture with the rests marked
(needs matplotlib, the extra "figures").
"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Adds the command to those of `mbkf imu`."""
    from mbkf.cli.imu import add_reading_options

    parser = subparsers.add_parser(
        "stride",
        help="stride lengths and foot paths from sensors on the feet",
        description="Measure every stride of one or two feet (length, duration, speed, height) and the path of the "
        "foot, from the accelerometer and gyroscope of a sensor worn on it.",
        epilog=_EPILOG,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="readings of one or several sensors")
    add_reading_options(parser)
    parser.add_argument(
        "--sensor",
        metavar="NAME",
        action="append",
        default=[],
        help="a foot's sensor, where the files hold others, too; may be repeated",
    )
    parser.add_argument(
        "--method", choices=("smoother", "filter", "key-points"), default="smoother", help="see below"
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
    parser.add_argument("--out", required=True, metavar="DIR", help="folder to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measures the strides, writes the folder and prints a table.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder
    from mbkf.trial.inertial.stride import measure_strides
    from mbkf.trial.inertial.stride_folder import write_strides

    check_folder(args.out)
    settings = _settings(args)
    readings = _feet(args)
    with stages() as report:
        measured = measure_strides(readings, settings, progress=report)
    folder = write_strides(measured, args.out)
    _draw(measured, folder / PICTURE_FILE)
    _print(measured, str(args.out))
    return 0


def _draw(measured: StrideMeasurement, path: Path) -> None:
    from mbkf.errors import MissingDependency

    try:
        from mbkf.viz.imu.foot_path import write_foot_path
    except MissingDependency as missing:
        path.unlink(missing_ok=True)  # an earlier run's picture shows other strides
        print(f"note: {path.name} was not drawn. {missing}", file=sys.stderr)
    else:
        write_foot_path(measured, path)


def _settings(args: argparse.Namespace) -> StrideSettings:
    from mbkf.errors import InvalidInput
    from mbkf.imu.foot_filter import LEVEL_M, FootFilterSettings
    from mbkf.imu.key_points import KeyPointSettings
    from mbkf.trial.inertial.stride import StrideSettings

    own = {name: getattr(args, name) for name in ("threshold", "window") if getattr(args, name) is not None}
    if args.weights is not None:
        try:
            own["weights"] = tuple(float(word) for word in args.weights.split(","))
        except ValueError as error:
            raise InvalidInput(
                f"--weights {args.weights}: give three numbers, as in 0.1,0.45,0.45"
            ) from error
        if len(own["weights"]) != 3:
            raise InvalidInput(f"--weights {args.weights}: give three numbers, as in 0.1,0.45,0.45")
    if own and args.method != "key-points":
        raise InvalidInput(f"--{next(iter(own))} belongs to --method key-points")
    if args.level and args.method == "key-points":
        raise InvalidInput("--level belongs to the Kalman filter; leave it out with --method key-points")
    kalman = FootFilterSettings(level_m=LEVEL_M if args.level else None)
    return StrideSettings(method=args.method, kalman=kalman, key_points=KeyPointSettings(**own))


def _feet(args: argparse.Namespace) -> list[ImuReadings]:
    """The readings of one or two sensors, by name where there are more."""
    from mbkf.cli.imu import read
    from mbkf.errors import InvalidInput, UnknownName

    found = list(read(args.files, args))
    names = [one.name for one in found]
    for name in args.sensor:
        if name not in names:
            raise UnknownName("sensor", name, names, "--sensor")
    if args.sensor:
        found = [found[names.index(name)] for name in dict.fromkeys(args.sensor)]
    if not 1 <= len(found) <= _MOST_FEET:
        raise InvalidInput(
            f"{len(found)} sensors: {', '.join(one.name for one in found) or 'none'}; name those of one or two feet "
            "with --sensor"
        )
    return found


def _print(measured: StrideMeasurement, out: str) -> None:
    from rich.console import Console
    from rich.table import Table

    from mbkf.trial.inertial.stride import STRAIGHT_DEG, stride_summary

    summary: dict[str, Any] = stride_summary(measured)
    table = Table(title=f"{out}: {summary['method_meaning']}", title_justify="left")
    headings: Sequence[str] = ("foot", "strides", "length m", "duration s", "speed m/s", "walked m")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "foot" else "right", no_wrap=heading != "foot")
    for name, numbers in summary["feet"].items():
        spread = [
            _spread(numbers[f"{key}_mean"], numbers[f"{key}_sd"])
            for key in ("length_m", "duration_s", "speed_m_s")
        ]
        table.add_row(name, str(numbers["strides"]), *spread, f"{numbers['distance_m']:.2f}")
    console = Console(highlight=False)
    console.print(table)
    console.print(f"mean ± spread over strides that turn by less than {STRAIGHT_DEG:g}°")
    both = summary.get("both_feet")
    if both and both["step_time_s_median"]:
        console.print(
            f"both feet: {both['steps']} steps, {both['cadence_steps_per_min']:.0f} per minute, "
            f"step time {both['step_time_s_median']:.2f} s"
        )
    for warning in summary["warnings"]:
        console.print(f"[yellow]warning:[/] {warning}")


def _spread(mean: float | None, sd: float | None) -> str:
    if mean is None:
        return "–"
    return f"{mean:.2f}" if sd is None else f"{mean:.2f} ± {sd:.2f}"
