"""Orientation from accelerometer, gyroscope and magnetometer.

Orientation of every sensor by an error-state Kalman filter with later readings (--filter smooth), without them (ekf),
or by Madgwick's filter. Files: CSV tables with units in their column names, makers' exports (or a folder of them),
MATLAB files of the BROAD and qmt sets.

--compare sets a second filter beside the first, or the sensor's own quaternions: those in the same file (--compare
file) or in another one, such as a maker's export of quaternions. --initial gives the first orientation, as a maker's
calibration knows it; without it the filter takes that of the first readings. A smoother corrects it by later ones.

Examples:
  mbkf imu orient thigh.csv --frame ENU --out result
  mbkf imu orient left_foot.csv right_foot.csv --units acc=g,gyr=deg/s --rate 204.8 --frame NWU --out result
  mbkf imu orient trial.mat --frame ENU --filter madgwick --beta 0.1 --compare ekf --out result
  mbkf imu orient physical.csv --units acc=m/s2,gyr=rad/s,mag=uT --rate 60 --frame NWU --filter madgwick --beta 0.35 \
      --compare quaternions.csv --initial compared --out result

Writes orientation.json, and for each sensor NAME.csv (quaternion sensor -> world as x, y, z, w; unwrapped roll, pitch,
yaw) and with --compare NAME_compare.csv (the differences over time) and NAME_compare.png (needs matplotlib, the extra
'figures').
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbkf.cli.imu import add_reading_options, read
from mbkf.cli.options import add_out

if TYPE_CHECKING:
    from mbkf.imu.orientation import Orientation


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    filters = ("madgwick", "ekf", "smooth")
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings")
    add_reading_options(parser)
    parser.add_argument(
        "--frame", required=True, choices=("ENU", "NED", "NWU"), help="world frame of the result"
    )
    parser.add_argument(
        "--filter", default="smooth", choices=filters, help="smooth: ekf with later readings (%(default)s)"
    )
    parser.add_argument(
        "--compare",
        metavar="FILTER|file|FILE",
        help="a second filter, 'file' for the orientations in the file, or another file with quaternions",
    )
    parser.add_argument(
        "--initial",
        metavar="W,X,Y,Z|compared",
        type=initial,
        help="first orientation in --frame: a unit quaternion, or the first one of the file compared with",
    )
    parser.add_argument("--beta", type=float, default=0.1, help="Madgwick's gain, rad/s (%(default)s)")
    parser.add_argument("--zeta", type=float, default=0.0, help="Madgwick's gain of the gyroscope's bias (0)")
    parser.add_argument("--no-mag", action="store_true", help="ignore magnetometers")
    parser.add_argument(
        "--rest-bias",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="read the gyroscope's bias while a sensor lies still (ekf, smooth; default: yes)",
    )
    add_out(parser, "DIR", "folder to write", required=True)


def initial(text: str) -> list[float] | str:
    """Reads ``w,x,y,z`` as x, y, z, w; the word ``compared`` as it is.

    Raises:
        ArgumentTypeError: The text is neither.
    """
    from mbkf.trial.inertial.orient import COMPARED

    if text == COMPARED:
        return text
    try:
        w, x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}': write four numbers as 1,0,0,0 (w first), or '{COMPARED}'"
        ) from None
    return [x, y, z, w]


def run(args: argparse.Namespace) -> int:
    """Filters the sensors, writes the folder and prints the key numbers."""
    from mbkf.cli.progress import stages
    from mbkf.imu.madgwick import MadgwickSettings
    from mbkf.imu.orientation import OrientSettings
    from mbkf.imu.orientation_ekf import OrientationSettings
    from mbkf.io.atomic import check_folder, write_text
    from mbkf.io.atomic_folder import replacing_folder
    from mbkf.io.imu.write import write_orientation_csv
    from mbkf.trial.inertial.orient import orient, orientation_summary

    if args.compare:
        from mbkf.viz.imu.orientation import write_comparison
    settings = OrientSettings(
        args.filter,
        not args.no_mag,
        MadgwickSettings(args.beta, args.zeta),
        OrientationSettings(rest_bias=args.rest_bias),
    )
    folder, sensors = check_folder(args.out, ("orientation.json",)), read(args.files, args)
    with stages() as report:
        result = orient(
            sensors,
            frame=args.frame,
            settings=settings,
            compare=args.compare,
            start=args.initial,
            only=args.sensor,
            progress=report,
        )
    summary = orientation_summary(result, settings)
    with replacing_folder(folder, last="orientation.json") as partial:
        for k, course in enumerate(result.courses):
            stem = course.name.replace("/", "_")
            note = f"orientation: sensor -> {course.frame} by {course.method}"
            write_orientation_csv(
                partial / f"{stem}.csv", course.time_s, course.quaternion, course.euler_rad, course.gyro_bias_rad_s,
                course.sd_rad, note,
            )  # fmt: skip
            if result.compared:
                _write_difference(course, result.compared[k], partial / f"{stem}_compare.csv")
                write_comparison(course, result.compared[k], partial / f"{stem}_compare.png")
        write_text(partial / "orientation.json", json.dumps(summary, indent=2) + "\n")
    _print(summary)
    print(folder)
    return 0


def _write_difference(course: Orientation, compared: Orientation, path: Path) -> None:
    import numpy as np

    from mbkf.imu.orientation_difference import orientation_difference
    from mbkf.io.imu.write import write_difference_csv

    apart = orientation_difference(course.quaternion, compared.quaternion)
    turns = np.column_stack([apart.euler_rad, apart.angle_rad, apart.heading_rad, apart.inclination_rad])
    note = f"orientation: sensor -> {course.frame} by {compared.method}; differences from {course.method}"
    write_difference_csv(path, course.time_s, apart.quaternion, apart.components, turns, note)


def _print(summary: dict[str, Any]) -> None:
    for one in summary["sensors"]:
        line = f"{one['name']}: {one['samples']} samples, {summary['method']} in {summary['frame']}"
        for key, text in (("error_deg", "error"), ("error_moving_deg", "error in movement")):
            if (e := one[key]) is not None:
                parts = f"inclination {e['inclination']:.2f}, heading {e['heading']:.2f}"
                line += f"; {text} {e['total']:.2f} deg ({parts})"
        if "difference_rms_deg" in one:
            line += f"; {summary['compared_with']} differs by {one['difference_rms_deg']['total']:.2f} deg"
        print(line)
    for warning in summary["warnings"]:
        print(f"note: {warning}")
