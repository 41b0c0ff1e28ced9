"""Follow sensors on pelvis, chest and legs live: motion, reactions and torques.

Sensors are named after their segments, as for 'mbkf imu motion'; they come as one LSL stream or as one stream each. No
magnetometer is needed. Xsens MVN sends orientations of segments over UDP. The person stands still for a second, which
calibrates the sensors, and then moves. Ctrl-C or --seconds ends it; DIR then holds the files of 'mbkf imu motion', and
live.json.

Examples:
  mbkf imu live --from lsl --subject subject.toml --view --out result
  mbkf imu live --from lsl --stream thigh --stream shank --stream pelvis --mass 72 --height 1.78 --out result
  mbkf imu live --from xsens --subject subject.toml --view --out result       (Xsens MVN's network streamer)
  mbkf imu live --from file:walk.csv --subject subject.toml --out result
"""

from __future__ import annotations

import argparse
import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbkf.cli.following import (
    add_following_options,
    add_speed_option,
    file_named,
    follow,
    report_outcome,
    say,
)
from mbkf.cli.imu import (
    add_person_options,
    add_posture_option,
    add_reading_options,
    parse_units,
    person_of,
    posture_of,
)
from mbkf.cli.live_source import add_character_option, xsens_source
from mbkf.cli.options import add_out, asked_spreads, lag_seconds

if TYPE_CHECKING:
    from mbkf.conventions import Array
    from mbkf.io.subject import Subject
    from mbkf.stream.run.session import LiveSession
    from mbkf.stream.source import FrameSource


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "--from",
        dest="source",
        metavar="lsl|xsens[:PORT]|file:FILE",
        required=True,
        help="source of the frames",
    )
    add_person_options(parser)
    add_posture_option(parser)
    add_reading_options(parser)
    parser.add_argument(
        "--stream",
        metavar="NAME",
        action="append",
        default=[],
        help="LSL: only these streams (default: all of inertial sensors)",
    )
    parser.add_argument(
        "--local", default="127.0.0.1", metavar="ADDRESS", help="Xsens: address of this computer"
    )
    parser.add_argument("--up", metavar="AXIS", help="Xsens: vertical axis (default: as the posture shows)")
    add_character_option(parser)
    add_speed_option(parser)
    add_out(parser, "DIR", "folder to write", required=True)
    add_following_options(parser)


def run(args: argparse.Namespace) -> int:
    """Follows the stream, writes the folder and prints the key numbers."""
    from mbkf.model.human import HumanModel

    person = person_of(args)
    posture = posture_of(args, HumanModel.of(person))
    return follow_sensors(args, _source(args), person, posture, args.sensor)


def follow_sensors(
    args: argparse.Namespace,
    source: FrameSource,
    person: Subject,
    posture: Array | None = None,
    only: Sequence[str] = (),
) -> int:
    """Follows a source of inertial sensors.

    Args:
        args: Options of commands that follow a stream, ``--from`` and ``--out``.
        source: The source.
        person: The wearer.
        posture: (nq,) posture while standing; None for the neutral one.
        only: Sensors to use; all by default.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.atomic import check_folder
    from mbkf.io.results_folder import RESULT_FILES
    from mbkf.model.human import HumanModel
    from mbkf.stream.run.report import LIVE_FILE
    from mbkf.stream.run.sensor_standing import MOUNTS_FILE, SensorStanding
    from mbkf.stream.run.session import LiveSession
    from mbkf.trial.preparation.settings import ReconstructSettings

    folder = check_folder(args.out, (LIVE_FILE, MOUNTS_FILE, *RESULT_FILES))
    settings = ReconstructSettings(
        lag_s=lag_seconds(args), correct_markers=False, checks=False, spreads=asked_spreads(args)
    )
    model, name = HumanModel.of(person), args.source.partition(":")[0]

    def begin(stop: threading.Event, patience_s: float | None) -> LiveSession:
        start = SensorStanding(source, name, model, folder, say, posture=posture, only=only)
        found = start.find(stop, patience_s) if start.connect(stop, patience_s) else None
        if found is None:
            raise InvalidInput("stopped before the sensors were calibrated; nothing was written")
        session = LiveSession(found.source, person, settings, folder, name, found.report, sensors=found.worn)
        session.connect(stop, patience_s)
        return session

    return report_outcome(follow(args, source, begin), folder)


def _source(args: argparse.Namespace) -> FrameSource:
    if args.source == "lsl":
        from mbkf.stream.lsl.sensor_source import LslSensorSource

        return LslSensorSource(args.stream, parse_units(args.units))
    name, _, detail = args.source.partition(":")
    if name == "xsens":
        return xsens_source(args, detail)
    path = file_named(args.source, "file:SENSORS.csv", "lsl", "xsens")
    from pathlib import Path

    from mbkf.io.imu.files import read_imu_session
    from mbkf.stream.file_source import FileSource
    from mbkf.stream.played import played_sensors

    readings = read_imu_session([path], units=parse_units(args.units), rate_hz=args.rate)
    return FileSource(played_sensors(readings, Path(path).stem), args.speed)
