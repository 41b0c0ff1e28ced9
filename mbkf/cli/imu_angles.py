"""`mbkf imu angles`: joint angles of pelvis and legs from eight sensors."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.trial.inertial.angles import ImuAngles

_EPILOG = """\
examples:
  mbkf imu angles walk.csv --standing 0:3 --out result
  mbkf imu angles walk.csv --standing stand.csv --subject subject.toml --out result
  mbkf imu angles xsens_folder --from-file --standing 0:1 --out result

Sensors are named after their segments (pelvis, torso, right_thigh, femur_r, left_foot ...). The person stands upright,
faces forward and keeps still for a second or more: in the trial, or, with magnetometers, in a recording of its own.
Walking or leg swings in the trial show where forward is; without magnetometers sensors must be strapped on as usual:
box flat, z away from the body (on the feet up), x up the limb (on the feet forward).

Writes angles.mot (degrees), mounts.toml (how each sensor sits on its segment) and angles.json.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.imu import add_reading_options, add_standing_options

    parser = subparsers.add_parser(
        "angles",
        help="sensors on pelvis, chest and legs to joint angles",
        description="Hip, knee, ankle and trunk angles from inertial sensors, through the segment model.",
        epilog=_EPILOG,
    )
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
    parser.add_argument("--from-file", action="store_true", help="use the orientations that the file brings")
    parser.add_argument("--no-mag", action="store_true", help="leave magnetometers out")
    parser.add_argument(
        "--free-headings", action="store_true", help="do not let the joints hold the headings"
    )
    parser.add_argument("--sensor", metavar="NAME", action="append", default=[], help="only these sensors")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Finds the angles, writes the folder and prints the ranges of motion.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.imu import posture_told, read_session, standing_told
    from mbkf.cli.progress import stages
    from mbkf.errors import UnknownName
    from mbkf.imu.orientation import OrientSettings
    from mbkf.io.atomic import check_folder
    from mbkf.io.subject import read_subject
    from mbkf.model.human import HumanModel
    from mbkf.trial.inertial.angles import AnglesSettings, imu_angles

    folder = check_folder(args.out)
    model = HumanModel.scaled()
    if args.subject is not None:
        person = read_subject(args.subject)
        model = HumanModel.of(person)
    sensors = read_session(args.files, args)
    for name in args.sensor:
        if name not in [one.name for one in sensors]:
            raise UnknownName("sensor", name, [one.name for one in sensors])
    chosen = [one for one in sensors if not args.sensor or one.name in args.sensor]
    settings = AnglesSettings(
        OrientSettings(args.filter, not args.no_mag),
        args.from_file,
        not args.free_headings,
    )
    standing = standing_told(args)
    posture = None if args.posture is None else posture_told(args.posture, model)
    with stages() as report:
        found = imu_angles(
            chosen, model, standing=standing, posture=posture, settings=settings, progress=report
        )
    _write(found, folder, args)
    _print(found)
    print(folder)
    return 0


def _write(found: ImuAngles, folder: Path, args: argparse.Namespace) -> None:
    import numpy as np

    from mbkf.io.atomic_folder import replacing_folder
    from mbkf.io.imu.mount import write_mounts
    from mbkf.io.storage import Table, write_storage

    degrees = np.degrees(found.angles)
    summary = {
        "filter": "file" if args.from_file else args.filter,
        "samples": len(found.time_s),
        "range_deg": {
            name: [float(column.min()), float(column.max())]
            for name, column in zip(found.names, degrees.T, strict=True)
        },
        "mean_deg": {name: float(column.mean()) for name, column in zip(found.names, degrees.T, strict=True)},
        "warnings": list(found.warnings),
    }
    table = Table(found.names, found.time_s, degrees, in_degrees=True, title="Coordinates")
    with replacing_folder(folder, last="angles.json") as partial:
        write_storage(table, partial / "angles.mot")
        write_mounts(found.mounts, partial / "mounts.toml")
        (partial / "angles.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")


def _print(found: ImuAngles) -> None:
    import numpy as np

    for name, column in zip(found.names, np.degrees(found.angles).T, strict=True):
        print(f"{name}: {column.min():.1f} to {column.max():.1f} deg, mean {column.mean():.1f}")
    for warning in found.warnings:
        print(f"note: {warning}")
