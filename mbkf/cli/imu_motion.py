"""`mbkf imu motion`: a person's motion, reactions and torques from inertial sensors alone."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.trial.inertial.motion import InertialMotion

_EPILOG = """\
examples:
  mbkf imu motion walk.csv --mass 72 --height 1.78 --out result
  mbkf imu motion walk.csv --standing stand.csv --subject subject.toml --out result
  mbkf imu motion walk.csv --standing 0:3 --posture static/motion.h5 --subject subject.toml --out result
  mbkf imu motion leg.csv --sensor right_thigh --sensor right_shank --sensor right_foot --subject subject.toml --out leg

Sensors are named after their segments (pelvis, torso, right_thigh, femur_r, left_foot ...): eight of them, seven
without the chest, or three on a leg, which tell its knee and ankle. No magnetometer, camera or force plate is needed.
The person stands still for a second, in the trial or in a recording of its own; boxes are strapped on flat, z away
from the body, x up the limb (on the feet forward).
The floor is level. Reactions of the ground need sensors on both feet.

Writes the folder that `mbkf reconstruct` writes (summary.json, motion.h5, OpenSim's files) and mounts.toml.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.imu import add_person_options, add_reading_options, add_standing_options

    parser = subparsers.add_parser(
        "motion",
        help="sensors on pelvis, chest and legs to motion, reactions and torques, without magnetometers",
        description="Motion, path over the floor, ground reactions and joint torques from inertial sensors alone.",
        epilog=_EPILOG,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings of the trial")
    add_reading_options(parser)
    add_standing_options(parser)
    add_person_options(parser)
    parser.add_argument("--sensor", metavar="NAME", action="append", default=[], help="only these sensors")
    parser.add_argument(
        "--causal", action="store_true", help="no later frame corrects an earlier one, as live"
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Finds the motion, writes the folder and prints the ranges of motion.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.imu import person_told, posture_told, read_session, standing_told
    from mbkf.cli.progress import stages
    from mbkf.errors import UnknownName
    from mbkf.io.atomic import check_folder
    from mbkf.io.imu.mount import write_mounts
    from mbkf.io.results_folder import RESULT_FILES, write_reconstruction
    from mbkf.model.human import HumanModel
    from mbkf.trial.inertial.motion import InertialMotionSettings, inertial_motion
    from mbkf.trial.results.summary import summarise

    folder, person = check_folder(args.out, RESULT_FILES), person_told(args)
    sensors = read_session(args.files, args)
    for name in args.sensor:
        if name not in [one.name for one in sensors]:
            raise UnknownName("sensor", name, [one.name for one in sensors])
    posture = None if args.posture is None else posture_told(args.posture, HumanModel.of(person))
    with stages() as report:
        found = inertial_motion(
            [one for one in sensors if not args.sensor or one.name in args.sensor],
            person,
            standing=standing_told(args),
            posture=posture,
            trial=Path(args.files[0]).stem,
            settings=InertialMotionSettings(smooth=not args.causal),
            progress=report,
        )
    write_reconstruction(found.result, summarise(found.result), folder)
    write_mounts(found.mounts, Path(folder) / "mounts.toml")
    _print(found)
    print(folder)
    return 0


def _print(found: InertialMotion) -> None:
    """Ranges of the angles that sensors tell of, the path, and what is to be told."""
    import numpy as np

    result = found.result
    for name in TOLD:
        if name in result.coordinate_names:
            k = result.coordinate_names.index(name)
            angle, sd = np.degrees(result.angles[:, k]), np.degrees(result.angles_sd[:, k])
            print(f"{name}: {np.nanmin(angle):.1f} to {np.nanmax(angle):.1f} deg, sd {np.nanmean(sd):.1f}")
    path = float(np.linalg.norm(np.diff(result.q[:, :2], axis=0), axis=1).sum())
    print(f"path of the pelvis over the floor: {path:.1f} m in {result.frames / result.rate_hz:.1f} s")
    for warning in result.warnings:
        print(f"note: {warning}")


TOLD = tuple(
    f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in ("r", "l")
)
"""Angles whose ranges are printed."""
