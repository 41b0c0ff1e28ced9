"""Motion, reactions and torques from sensors on pelvis, chest and legs, without magnetometers.

Sensors are named after their segments (pelvis, torso, right_thigh, femur_r, left_foot …): eight of them, seven without
the chest, or three on a leg for its knee and ankle. No magnetometer, camera or force plate is needed. The person
stands still for a second, in the trial or in a recording of its own; boxes are strapped on flat, z away from the body,
x up the limb (on the feet forward). The floor is level. Reactions of the ground need sensors on both feet.

Examples:
  mbkf imu motion walk.csv --mass 72 --height 1.78 --out result
  mbkf imu motion walk.csv --standing stand.csv --subject subject.toml --out result
  mbkf imu motion walk.csv --standing 0:3 --posture static/motion.h5 --subject subject.toml --out result
  mbkf imu motion leg.csv --sensor right_thigh --sensor right_shank --sensor right_foot --subject subject.toml --out leg

Writes the folder that 'mbkf reconstruct' writes (summary.json, motion.h5, OpenSim's files), and mounts.toml.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.imu import (
    add_person_options,
    add_reading_options,
    add_standing_options,
    chosen,
    person_of,
    posture_of,
    read_session,
    standing_of,
)
from mbkf.cli.options import add_out

if TYPE_CHECKING:
    from mbkf.io.results import Reconstruction

PRINTED = tuple(
    f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in ("r", "l")
)
"""Angles whose ranges are printed."""

MOUNTS_FILE = "mounts.toml"
"""File of the sensors on the body that were found."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings of the trial")
    add_reading_options(parser)
    add_standing_options(parser)
    add_person_options(parser)
    parser.add_argument("--causal", action="store_true", help="use no later frames, as live")
    add_out(parser, "DIR", "folder to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Finds the motion, writes the folder and prints the ranges of motion."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder
    from mbkf.io.atomic_folder import replacing_folder
    from mbkf.io.imu.mount import write_mounts
    from mbkf.io.results_folder import RESULT_FILES, SUMMARY_FILE, write_result_files
    from mbkf.model.human import HumanModel
    from mbkf.trial.inertial.motion import InertialMotionSettings, inertial_motion
    from mbkf.trial.results.summary import summarise

    folder, person = check_folder(args.out, (*RESULT_FILES, MOUNTS_FILE)), person_of(args)
    sensors = chosen(read_session(args.files, args), args.sensor)
    posture = posture_of(args, HumanModel.of(person))
    with stages() as report:
        found = inertial_motion(
            sensors,
            person,
            standing=standing_of(args),
            posture=posture,
            trial=Path(args.files[0]).stem,
            settings=InertialMotionSettings(smooth=not args.causal),
            progress=report,
        )
    with replacing_folder(folder, last=SUMMARY_FILE) as partial:
        write_result_files(found.result, summarise(found.result), partial)
        write_mounts(found.mounts, partial / MOUNTS_FILE)
    _print(found.result)
    print(folder)
    return 0


def _print(result: Reconstruction) -> None:
    """Prints ranges of the measured angles, the length of the path, and warnings."""
    import numpy as np

    for name in PRINTED:
        if name in result.coordinate_names:
            k = result.coordinate_names.index(name)
            angle, sd = np.degrees(result.angles[:, k]), np.degrees(result.angles_sd[:, k])
            print(f"{name}: {np.nanmin(angle):.1f} to {np.nanmax(angle):.1f} deg, sd {np.nanmean(sd):.1f}")
    path = float(np.linalg.norm(np.diff(result.q[:, :2], axis=0), axis=1).sum())
    print(f"path of the pelvis over the floor: {path:.1f} m in {result.frames / result.rate_hz:.1f} s")
    for warning in result.warnings:
        print(f"note: {warning}")
