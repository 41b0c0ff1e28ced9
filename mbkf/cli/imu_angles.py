"""Joint angles from sensors on pelvis, chest and legs.

Hip, knee, ankle and trunk angles through the segment model. Sensors are named after their segments (pelvis, torso,
right_thigh, femur_r, left_foot …). The person stands upright, faces forward and keeps still for a second or more: in
the trial, or, with magnetometers, in a recording of its own. Walking or leg swings in the trial show the forward
direction; without magnetometers sensors must be strapped on as usual: box flat, z away from the body (on the feet up),
x up the limb (on the feet forward).

Examples:
  mbkf imu angles walk.csv --standing 0:3 --out result
  mbkf imu angles walk.csv --standing stand.csv --subject subject.toml --out result
  mbkf imu angles xsens_folder --from-file --standing 0:1 --out result

Writes angles.mot (degrees), mounts.toml (place of each sensor on its segment) and angles.json.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbkf.cli.imu import (
    add_reading_options,
    add_standing_options,
    chosen,
    posture_of,
    read_session,
    standing_of,
)
from mbkf.cli.options import add_out

if TYPE_CHECKING:
    from mbkf.trial.inertial.angles import ImuAngles


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings of the trial")
    add_reading_options(parser)
    add_standing_options(parser)
    parser.add_argument(
        "--subject", metavar="SUBJECT.toml", help="the scaled person (default: the reference body)"
    )
    parser.add_argument(
        "--filter",
        default="smooth",
        choices=("madgwick", "ekf", "smooth"),
        help="orientation filter (smooth)",
    )
    parser.add_argument("--from-file", action="store_true", help="use the orientations of the file")
    parser.add_argument("--no-mag", action="store_true", help="ignore magnetometers")
    parser.add_argument(
        "--free-headings", action="store_true", help="do not let the joints hold the headings"
    )
    add_out(parser, "DIR", "folder to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Finds the angles, writes the folder and prints the ranges of motion."""
    from mbkf.cli.progress import stages
    from mbkf.imu.orientation import OrientSettings
    from mbkf.io.atomic import check_folder
    from mbkf.io.subject import read_subject
    from mbkf.model.human import HumanModel
    from mbkf.trial.inertial.angles import AnglesSettings, imu_angles

    folder = check_folder(args.out, ("angles.mot", "mounts.toml", "angles.json"))
    model = HumanModel.scaled() if args.subject is None else HumanModel.of(read_subject(args.subject))
    sensors = chosen(read_session(args.files, args), args.sensor)
    settings = AnglesSettings(
        OrientSettings(args.filter, not args.no_mag), args.from_file, not args.free_headings
    )
    standing, posture = standing_of(args), posture_of(args, model)
    with stages() as report:
        found = imu_angles(
            sensors, model, standing=standing, posture=posture, settings=settings, progress=report
        )
    summary = _summary(found, "file" if args.from_file else args.filter)
    _write(found, summary, folder)
    for name, (least, most) in summary["range_deg"].items():
        print(f"{name}: {least:.1f} to {most:.1f} deg, mean {summary['mean_deg'][name]:.1f}")
    for warning in found.warnings:
        print(f"note: {warning}")
    print(folder)
    return 0


def _summary(found: ImuAngles, filter_name: str) -> dict[str, Any]:
    import numpy as np

    columns = dict(zip(found.names, np.degrees(found.angles).T, strict=True))
    return {
        "filter": filter_name,
        "samples": len(found.time_s),
        "range_deg": {name: [float(column.min()), float(column.max())] for name, column in columns.items()},
        "mean_deg": {name: float(column.mean()) for name, column in columns.items()},
        "warnings": list(found.warnings),
    }


def _write(found: ImuAngles, summary: dict[str, Any], folder: Path) -> None:
    import numpy as np

    from mbkf.io.atomic import write_text
    from mbkf.io.atomic_folder import replacing_folder
    from mbkf.io.imu.mount import write_mounts
    from mbkf.io.storage import Table, write_storage

    degrees = np.degrees(found.angles + found.opensim_zeros_rad)
    table = Table(found.names, found.time_s, degrees, in_degrees=True, title="Coordinates")
    with replacing_folder(folder, last="angles.json") as partial:
        write_storage(table, partial / "angles.mot")
        write_mounts(found.mounts, partial / "mounts.toml")
        write_text(partial / "angles.json", json.dumps(summary, indent=2) + "\n")
