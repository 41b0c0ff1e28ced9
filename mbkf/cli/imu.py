"""`mbkf imu`: orientation, tuning, joint angles, motion (also live), virtual sensors and strides."""

from __future__ import annotations

import argparse
import importlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.conventions import Array
    from mbkf.io.imu.readings import ImuReadings
    from mbkf.io.subject import Subject
    from mbkf.model.human import HumanModel

SUBCOMMANDS = ("orient", "tune", "synth", "angles", "motion", "live", "replay", "stride")
"""Each is the module ``mbkf.cli.imu_<name>``."""

_EPILOG = """\
examples:
  mbkf imu orient thigh.csv --frame ENU --filter ekf --compare madgwick --out result
  mbkf imu tune thigh.csv
  mbkf imu synth truth.h5 --subject subject.toml --out imus.csv

`mbkf imu COMMAND --help` explains a command and gives an example.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the group to the command line."""
    parser = subparsers.add_parser(
        "imu",
        help="inertial sensors: orientation, tuning, joint angles, motion (also live), virtual sensors, stride length",
        description="Work with inertial sensors.",
        epilog=_EPILOG,
    )
    group = parser.add_subparsers(dest="imu_command", metavar="COMMAND", required=True, title="commands")
    for name in SUBCOMMANDS:
        importlib.import_module(f"mbkf.cli.imu_{name}").add_parser(group)


def run(args: argparse.Namespace) -> int:
    """Runs the command of the group that was named."""
    return int(importlib.import_module(f"mbkf.cli.imu_{args.imu_command}").run(args))


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Options of every command that reads sensors."""
    parser.add_argument(
        "--units",
        metavar="acc=g,gyr=deg/s",
        default="",
        help="units of a table that does not state them: acc m/s2, g, mg; gyr rad/s, deg/s; mag uT, nT, gauss, au",
    )
    parser.add_argument(
        "--rate", type=float, metavar="HZ", help="sample rate of a file that does not state it"
    )


def add_standing_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that calibrate sensors on a person who stands."""
    parser.add_argument(
        "--standing", metavar="T0:T1|FILE", help="when the person stands, s, or a recording of it"
    )
    parser.add_argument(
        "--posture", metavar="MOTION.h5", help="the posture while standing (default: the neutral one)"
    )
    parser.add_argument(
        "--started-together",
        action="store_true",
        help="several files: they started at the same moment, whatever their clocks tell",
    )


def add_person_options(parser: argparse.ArgumentParser) -> None:
    """Options that tell who wears the sensors."""
    parser.add_argument("--subject", metavar="SUBJECT.toml", help="the scaled person")
    parser.add_argument("--mass", metavar="KG", type=float, help="body mass of a person who is not scaled")
    parser.add_argument("--height", metavar="M", type=float, help="body height of a person who is not scaled")


def person_told(args: argparse.Namespace) -> Subject:
    """The person of a file, or of a mass and a height.

    Raises:
        MbkfError: The file cannot be read, or nobody is told.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import read_subject
    from mbkf.scaling.stature import person_of_stature

    if args.subject is not None:
        if args.mass is not None or args.height is not None:
            raise InvalidInput(
                "--mass and --height are for a person who is not scaled; leave them out beside --subject"
            )
        return read_subject(args.subject)
    if args.mass is None or args.height is None:
        raise InvalidInput("who wears the sensors? give --subject SUBJECT.toml, or --mass KG and --height M")
    return person_of_stature(args.mass, args.height)


def standing_told(args: argparse.Namespace) -> tuple[float, float] | tuple[ImuReadings, ...] | None:
    """A time window, a recording, or nothing."""
    from pathlib import Path

    from mbkf.errors import InvalidInput

    if args.standing is None:
        return None
    if Path(args.standing).exists():
        return read_session([args.standing], args)
    first, _, last = args.standing.partition(":")
    try:
        window = float(first), float(last)
    except ValueError:
        window = (1.0, 0.0)
    if not window[0] < window[1]:
        raise InvalidInput(f"--standing '{args.standing}': write START:END in s, or name a recording")
    return window


def posture_told(path: str, model: HumanModel) -> Array:
    """(nq,) configuration in the middle of a standing motion."""
    from mbkf.errors import InvalidInput
    from mbkf.trial.inertial.synth import read_motion

    motion = read_motion(path)
    if motion.model.nq != model.nq:
        raise InvalidInput(f"{path}: another body; reconstruct the posture with this subject")
    middle: Array = motion.q[len(motion.q) // 2]
    return middle


def read(paths: Sequence[str], args: argparse.Namespace) -> tuple[ImuReadings, ...]:
    """The sensors of all files named on the command line, each on its own clock.

    Raises:
        MbkfError: A file or a unit cannot be used.
    """
    from dataclasses import replace
    from pathlib import Path

    from mbkf.io.imu.files import read_imu

    units = parse_units(args.units)
    found = [(path, one) for path in paths for one in read_imu(path, units=units, rate_hz=args.rate)]
    if len({one.name for _, one in found}) < len(found):
        found = [(path, replace(one, name=f"{Path(path).stem}_{one.name}")) for path, one in found]
    return tuple(one for _, one in found)


def read_session(paths: Sequence[str], args: argparse.Namespace) -> tuple[ImuReadings, ...]:
    """The sensors of all files named on the command line, on one clock.

    Raises:
        MbkfError: A file or a unit cannot be used, or the sensors have no time in common.
    """
    from mbkf.io.imu.files import read_imu_session

    return read_imu_session(
        paths, units=parse_units(args.units), rate_hz=args.rate, started_together=args.started_together
    )


def parse_units(text: str) -> dict[str, str]:
    """Reads ``acc=g,gyr=deg/s``.

    Raises:
        InvalidInput: The text is not of that form.
    """
    from mbkf.errors import InvalidInput

    found = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        kind, equals, unit = part.partition("=")
        if not equals or not unit.strip():
            raise InvalidInput(f"--units '{part}': write QUANTITY=UNIT, as in acc=g or gyr=deg/s")
        found[kind.strip().lower()] = unit.strip()
    return found
