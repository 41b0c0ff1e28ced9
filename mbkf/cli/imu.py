"""Inertial sensors: orientation, tuning, joint angles, motion (also live), virtual sensors, stride length.

Examples:
  mbkf imu orient thigh.csv --frame ENU --filter ekf --compare madgwick --out result
  mbkf imu tune thigh.csv
  mbkf imu synth truth.h5 --subject subject.toml --out imus.csv

`mbkf imu COMMAND --help` explains a command and gives an example.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbkf.cli.options import body_mass, positive, time_window

if TYPE_CHECKING:
    from mbkf.conventions import Array
    from mbkf.io.imu.readings import ImuReadings
    from mbkf.io.subject import Subject
    from mbkf.model.human import HumanModel

SUBCOMMANDS = ("orient", "tune", "synth", "angles", "motion", "live", "replay", "stride")
"""Each is the module ``mbkf.cli.imu_<name>``."""


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of commands that read sensors."""
    parser.add_argument(
        "--units",
        metavar="acc=g,gyr=deg/s",
        default="",
        help="units of a table that does not state them: acc m/s2, g, mg; gyr rad/s, deg/s; mag uT, nT, gauss, au",
    )
    parser.add_argument(
        "--rate", type=float, metavar="HZ", help="sample rate of a file that does not state it"
    )
    parser.add_argument(
        "--sensor", metavar="NAME", action="append", default=[], help="only this sensor; may be repeated"
    )


def add_together_option(parser: argparse.ArgumentParser) -> None:
    """Adds the option of commands that read several files of one recording."""
    parser.add_argument(
        "--started-together",
        action="store_true",
        help="several files: ignore their clocks, they started at the same moment",
    )


def add_posture_option(parser: argparse.ArgumentParser) -> None:
    """Adds the posture of a person who stands for the calibration."""
    parser.add_argument("--posture", metavar="MOTION.h5", help="the standing posture (default: neutral)")


def add_standing_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of commands that calibrate sensors on a person who stands."""
    parser.add_argument(
        "--standing", metavar="T0:T1|FILE", help="time in which the person stands, s, or a recording of it"
    )
    add_posture_option(parser)
    add_together_option(parser)


def add_person_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options that name the wearer of the sensors."""
    parser.add_argument("--subject", metavar="SUBJECT.toml", help="the scaled person")
    add_stature_options(parser)


def add_stature_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of a person who is not scaled."""
    parser.add_argument(
        "--mass", metavar="KG", type=body_mass, help="body mass of a person who is not scaled"
    )
    parser.add_argument("--height", metavar="M", type=positive, help="height of a person who is not scaled")


def person_of(args: argparse.Namespace) -> Subject:
    """The person of a subject file, or of a mass and a height.

    Raises:
        InvalidInput: The options name no person, or two.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import read_subject
    from mbkf.scaling.stature import person_of_stature

    if args.subject is not None:
        if args.mass is not None or args.height is not None:
            raise InvalidInput(
                "--mass and --height are for a person who is not scaled, and --subject names one; give one of both"
            )
        return read_subject(args.subject)
    if args.mass is None or args.height is None:
        raise InvalidInput(
            "name the wearer of the sensors: --subject SUBJECT.toml, or --mass KG and --height M"
        )
    return person_of_stature(args.mass, args.height)


def standing_of(args: argparse.Namespace) -> tuple[float, float] | tuple[ImuReadings, ...] | None:
    """The time window of ``--standing``, or the recording that it names; None where not given."""
    from pathlib import Path

    if args.standing is None:
        return None
    if Path(args.standing).exists():
        return read_session([args.standing], args)
    return time_window("--standing", args.standing)


def posture_of(args: argparse.Namespace, model: HumanModel) -> Array | None:
    """(nq,) configuration in the middle of the motion that ``--posture`` names; None where not given.

    Raises:
        InvalidInput: The motion belongs to another body.
    """
    if args.posture is None:
        return None
    from mbkf.errors import InvalidInput
    from mbkf.trial.inertial.synth import read_motion

    motion = read_motion(args.posture)
    if motion.model.nq != model.nq:
        raise InvalidInput(f"{args.posture} holds another body; reconstruct the posture with this subject")
    middle: Array = motion.q[len(motion.q) // 2]
    return middle


def read(paths: Sequence[str], args: argparse.Namespace) -> tuple[ImuReadings, ...]:
    """The sensors of all files, each on its own clock; equal names get their file's name in front."""
    from dataclasses import replace
    from pathlib import Path

    from mbkf.io.imu.files import read_imu

    units = parse_units(args.units)
    found = [(path, one) for path in paths for one in read_imu(path, units=units, rate_hz=args.rate)]
    if len({one.name for _, one in found}) < len(found):
        found = [(path, replace(one, name=f"{Path(path).stem}_{one.name}")) for path, one in found]
    return tuple(one for _, one in found)


def read_session(paths: Sequence[str], args: argparse.Namespace) -> tuple[ImuReadings, ...]:
    """The sensors of all files on one clock."""
    from mbkf.io.imu.files import read_imu_session

    return read_imu_session(
        paths, units=parse_units(args.units), rate_hz=args.rate, started_together=args.started_together
    )


def chosen(readings: Sequence[ImuReadings], names: Sequence[str]) -> list[ImuReadings]:
    """The sensors of the given names; all without names.

    Raises:
        UnknownName: A sensor is not there.
    """
    from mbkf.errors import UnknownName

    known = [one.name for one in readings]
    for name in names:
        if name not in known:
            raise UnknownName("sensor", name, known, "--sensor")
    return [one for one in readings if not names or one.name in names]


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
