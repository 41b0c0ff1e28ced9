"""Readings of virtual sensors on a reconstructed, synthetic or AMASS motion.

Computes the readings from the motion's own velocities and accelerations. A motion of AMASS (SMPL, SMPL-H or SMPL-X
parameters, .npz) moves the segments of the person of --subject, or of --mass and --height, by its joint rotations; its
betas are not used, since they need a licensed model.

Examples:
  mbkf imu synth result/motion.h5 --out imus.csv
  mbkf imu synth walk7/truth.h5 --segments right_thigh,right_foot --rate 60 --seed 3 --out imus.csv
  mbkf imu synth walk7/truth.h5 --mounts mounts.toml --perfect --out imus.csv
  mbkf imu synth S1_Walking_poses.npz --mass 72 --height 1.78 --rate 60 --out imus.csv

Writes angular velocity, specific force and magnetic field of every sensor with the true orientation (NWU, x of the
motion's world as north), and FILE.toml with the sensors' places.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.imu import add_stature_options, person_of
from mbkf.cli.options import add_out, comma_separated, natural

if TYPE_CHECKING:
    from mbkf.trial.inertial.synth import BodyMotion

DEGREES, SI = math.pi / 180.0, 1.0
ERRORS = {
    "gyro-noise": ("gyro_noise", DEGREES, "deg/s/sqrt(Hz)"),
    "gyro-bias": ("gyro_bias_sd_rad_s", DEGREES, "deg/s"),
    "gyro-drift": ("gyro_drift", DEGREES, "deg/s/sqrt(s)"),
    "acc-noise": ("accelerometer_noise", SI, "m/s2/sqrt(Hz)"),
    "acc-bias": ("accelerometer_bias_sd_mps2", SI, "m/s2"),
    "mag-noise": ("magnetometer_noise_ut", SI, "uT"),
}
"""Options of the sensors' errors: name in :class:`ImuErrors`, factor to its unit, unit on the command line."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "motion", metavar="MOTION", help="motion.h5 of 'reconstruct', truth.h5 of 'synth', or .npz of AMASS"
    )
    parser.add_argument(
        "--subject", metavar="SUBJECT.toml", help="of a truth.h5 (default: subject.toml beside it) or an .npz"
    )
    add_stature_options(parser)
    parser.add_argument(
        "--up", choices=("z", "y"), help="upward axis of an .npz (default: z, as AMASS has it)"
    )
    parser.add_argument("--segments", metavar="A,B", help="segments with a sensor (default: the usual eight)")
    parser.add_argument(
        "--mounts", metavar="FILE.toml", help="sensors placed anywhere, instead of --segments"
    )
    parser.add_argument("--rate", type=float, metavar="HZ", help="sample rate (default: the motion's)")
    parser.add_argument("--seed", type=natural, default=0, metavar="N", help="of errors and placement (0)")
    parser.add_argument("--perfect", action="store_true", help="sensors without errors")
    parser.add_argument("--neat", action="store_true", help="sensors exactly at their usual places")
    for name, (_, _, unit) in ERRORS.items():
        parser.add_argument(f"--{name}", type=float, metavar="SD", help=f"standard deviation, {unit}")
    add_out(parser, "FILE.csv", "file to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Makes the readings and writes them.

    Raises:
        InvalidInput: --out names no CSV file.
    """
    from dataclasses import replace

    from mbkf.errors import InvalidInput
    from mbkf.imu.placement import EIGHT
    from mbkf.imu.virtual import ImuErrors
    from mbkf.io.atomic import check_file
    from mbkf.io.atomic_folder import replacing_beside
    from mbkf.io.imu.mount import read_mounts, write_mounts
    from mbkf.io.imu.write import write_imu_csv
    from mbkf.trial.inertial.synth import synthesise_imus

    out = Path(args.out)
    if out.suffix.lower() != ".csv":
        raise InvalidInput(f"--out {out}: name a .csv file")
    check_file(out.with_suffix(".toml"))
    given = {name: getattr(args, name.replace("-", "_")) for name in ERRORS}
    errors = replace(
        ImuErrors.none() if args.perfect else ImuErrors(),
        **{ERRORS[name][0]: ERRORS[name][1] * sd for name, sd in given.items() if sd is not None},
    )
    mounts, readings = synthesise_imus(
        motion_of(args),
        segments=EIGHT if args.segments is None else comma_separated(args.segments),
        mounts=() if args.mounts is None else read_mounts(args.mounts),
        errors=errors,
        rate_hz=args.rate,
        seed=args.seed,
        careless=not args.neat,
    )
    with replacing_beside(out) as partial:
        write_imu_csv(readings, partial / out.name)
        write_mounts(mounts, partial / out.with_suffix(".toml").name)
    names = ", ".join(one.name for one in readings)
    print(f"{out}: {readings[0].samples} samples at {readings[0].rate_hz:g} Hz of {names}")
    print(out.with_suffix(".toml"))
    return 0


def motion_of(args: argparse.Namespace) -> BodyMotion:
    """The motion that the command names.

    Raises:
        InvalidInput: An option belongs to another kind of file, or an .npz lacks the person of --subject or --mass.
        FileFormatError: The file is missing or of another kind.
    """
    from mbkf.errors import InvalidInput
    from mbkf.trial.inertial.synth import read_amass_motion, read_motion

    if Path(args.motion).suffix.lower() == ".npz":
        return read_amass_motion(args.motion, person_of(args), args.up or "z")
    for name in ("mass", "height", "up"):
        if getattr(args, name) is not None:
            raise InvalidInput(
                f"--{name} is for an .npz of AMASS; {args.motion} states its own, leave --{name} out"
            )
    return read_motion(args.motion, args.subject)
