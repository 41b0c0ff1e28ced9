"""`mbkf imu synth`: what inertial sensors on a moving body would have read."""

from __future__ import annotations

import argparse
from pathlib import Path

_EPILOG = """\
examples:
  mbkf imu synth result/motion.h5 --out imus.csv
  mbkf imu synth walk7/truth.h5 --segments right_thigh,right_foot --rate 60 --seed 3 --out imus.csv
  mbkf imu synth walk7/truth.h5 --mounts mounts.toml --perfect --out imus.csv

Writes angular velocity, specific force and magnetic field of every sensor with the true orientation (NWU, x of the
motion's world as north), and beside it FILE.toml with where the sensors sit.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "synth",
        help="virtual sensors on a reconstructed or synthetic motion",
        description="Readings of virtual inertial sensors from a motion's own velocities and accelerations.",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "motion", metavar="MOTION.h5", help="motion.h5 of 'reconstruct' or truth.h5 of 'synth'"
    )
    parser.add_argument(
        "--subject", metavar="SUBJECT.toml", help="of a truth.h5 (default: subject.toml beside it)"
    )
    parser.add_argument("--segments", metavar="A,B", help="segments with a sensor (default: the usual eight)")
    parser.add_argument(
        "--mounts", metavar="FILE.toml", help="sensors placed anywhere, instead of --segments"
    )
    parser.add_argument("--rate", type=float, metavar="HZ", help="sample rate (default: the motion's)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="other errors and placement (0)")
    parser.add_argument("--perfect", action="store_true", help="sensors without errors")
    parser.add_argument("--neat", action="store_true", help="sensors put on exactly at their usual places")
    for name, unit in (("gyro-noise", "deg/s/sqrt(Hz)"), ("gyro-bias", "deg/s"), ("gyro-drift", "deg/s/sqrt(s)"),
                       ("acc-noise", "m/s2/sqrt(Hz)"), ("acc-bias", "m/s2"), ("mag-noise", "uT")):  # fmt: skip
        parser.add_argument(f"--{name}", type=float, metavar="SD", help=f"standard deviation, {unit}")
    parser.add_argument("--out", required=True, metavar="FILE.csv", help="file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Makes the readings and writes them.

    Raises:
        MbkfError: An input is unusable.
    """
    import math
    from dataclasses import replace

    from mbkf.errors import InvalidInput
    from mbkf.imu.placement import EIGHT
    from mbkf.imu.virtual import ImuErrors
    from mbkf.io.atomic import check_folder
    from mbkf.io.imu.mount import read_mounts, write_mounts
    from mbkf.io.imu.write import write_imu_csv
    from mbkf.trial.inertial.synth import read_motion, synthesise_imus

    out = Path(args.out)
    if out.suffix.lower() != ".csv":
        raise InvalidInput(f"--out {out}: name a .csv file")
    if args.seed < 0:
        raise InvalidInput(f"--seed must be 0 or more, got {args.seed}")
    check_folder(out.parent)
    degree = math.pi / 180.0
    given = {
        "gyro_noise": (args.gyro_noise, degree), "gyro_bias_sd_rad_s": (args.gyro_bias, degree),
        "gyro_drift": (args.gyro_drift, degree), "accelerometer_noise": (args.acc_noise, 1.0),
        "accelerometer_bias_sd_mps2": (args.acc_bias, 1.0), "magnetometer_noise_ut": (args.mag_noise, 1.0),
    }  # fmt: skip
    errors = replace(
        ImuErrors.none() if args.perfect else ImuErrors(),
        **{name: factor * value for name, (value, factor) in given.items() if value is not None},
    )
    motion = read_motion(args.motion, args.subject)
    mounts, readings = synthesise_imus(
        motion,
        segments=EIGHT if args.segments is None else [name.strip() for name in args.segments.split(",")],
        mounts=() if args.mounts is None else read_mounts(args.mounts),
        errors=errors,
        rate_hz=args.rate,
        seed=args.seed,
        careless=not args.neat,
    )
    write_imu_csv(readings, out)
    write_mounts(mounts, out.with_suffix(".toml"))
    names = ", ".join(one.name for one in readings)
    print(f"{out}: {readings[0].samples} samples at {readings[0].rate_hz:g} Hz of {names}")
    print(out.with_suffix(".toml"))
    return 0
