"""`mbkf imu live`: follows a person through a stream of inertial sensors and tells the motion as it comes."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from mbkf.cli.live_output import add_output_options, say, sinks, told

if TYPE_CHECKING:
    from mbkf.stream.source import FrameSource

LEAST_PATIENCE_S = 30.0
"""With a time limit, a stream that never appears is waited for at least so long."""

FILE_PREFIX = "file:"

_EPILOG = """\
examples:
  mbkf imu live --from lsl --subject subject.toml --view --out result
  mbkf imu live --from lsl --stream thigh --stream shank --stream pelvis --mass 72 --height 1.78 --out result
  mbkf imu live --from file:walk.csv --subject subject.toml --out result

Sensors are named after their segments, as for 'mbkf imu motion'; they come as one LSL stream or as one stream each. No
magnetometer is needed. The person stands still for a second, which calibrates the sensors, and then moves. Ctrl-C or
--seconds ends it; DIR then holds what 'mbkf imu motion' writes, and live.json.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.imu import add_person_options, add_reading_options
    from mbkf.cli.options import add_lag_option, add_spreads_option

    parser = subparsers.add_parser(
        "live",
        help="sensors on pelvis, chest and legs to motion, reactions and torques, as they come",
        description="Follow a person through a live stream of inertial sensors, frame by frame.",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "--from", dest="source", metavar="lsl|file:FILE", required=True, help="where frames come from"
    )
    add_person_options(parser)
    parser.add_argument(
        "--posture", metavar="MOTION.h5", help="the posture while standing (default: the neutral one)"
    )
    parser.add_argument("--sensor", metavar="NAME", action="append", default=[], help="only these sensors")
    parser.add_argument(
        "--stream",
        metavar="NAME",
        action="append",
        default=[],
        help="LSL: only these streams (default: all of inertial sensors)",
    )
    add_reading_options(parser)
    add_lag_option(parser)
    add_spreads_option(parser)
    parser.add_argument("--view", action="store_true", help="show it in the browser")
    parser.add_argument(
        "--seconds", type=float, metavar="S", help="end after this time, from the first frame"
    )
    parser.add_argument(
        "--speed",
        type=float,
        default=1.0,
        metavar="X",
        help="file: times real time; 0 for as fast as it goes",
    )
    parser.add_argument("--out", metavar="DIR", required=True, help="folder to write")
    add_output_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Follows the stream, writes the folder and prints the key numbers.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.imu import person_told, posture_told
    from mbkf.cli.options import asked_spreads, check_positive, lag_seconds
    from mbkf.cli.stopping import stop_with_input, stopped_by_signal
    from mbkf.errors import InvalidInput
    from mbkf.io.atomic import check_folder
    from mbkf.model.human import HumanModel
    from mbkf.stream.run.sensor_standing import SensorStanding
    from mbkf.stream.run.session import LiveSession
    from mbkf.trial.preparation.settings import ReconstructSettings

    if args.seconds is not None:
        check_positive("--seconds", args.seconds)
    check_positive("--speed", args.speed, or_zero=True)
    person, folder = person_told(args), check_folder(args.out)
    model = HumanModel.of(person)
    posture = None if args.posture is None else posture_told(args.posture, model)
    settings = ReconstructSettings(
        lag_s=lag_seconds(args), correct_markers=False, checks=False, spreads=asked_spreads(args)
    )
    source, name = _source(args), args.source.partition(":")[0]
    patience = None if args.seconds is None else max(args.seconds, LEAST_PATIENCE_S)
    with stopped_by_signal() as stop:
        if args.end_with_input:
            stop_with_input(stop)
        say(f"waiting for {args.source} …")
        try:
            start = SensorStanding(source, name, model, folder, say, posture=posture, only=args.sensor)
            found = start.find(stop, patience) if start.connect(stop, patience) else None
            if found is None:
                raise InvalidInput("stopped before the sensors were calibrated; nothing was written")
            session = LiveSession(
                found.source, person, settings, folder, name, found.report, sensors=found.worn
            )
            session.connect(stop, patience)
            listeners = sinks(args, session)
        except BaseException:
            source.close()
            raise
        stream = session.setup.stream
        say(f"following {stream.trial}: {len(stream.sensors)} sensors at {stream.rate_hz:g} Hz")
        outcome = session.run(stop, listeners, args.seconds, keep_log=args.keep_log)
    return told(outcome, folder)


def _source(args: argparse.Namespace) -> FrameSource:
    from mbkf.cli.imu import parse_units
    from mbkf.errors import InvalidInput, UnknownName

    if args.source == "lsl":
        from mbkf.stream.lsl.sensor_source import LslSensorSource

        return LslSensorSource(args.stream, parse_units(args.units))
    if not args.source.startswith(FILE_PREFIX):
        raise UnknownName("source", args.source, ("lsl", "file:FILE"), "--from")
    path = args.source.removeprefix(FILE_PREFIX)
    if not path:
        raise InvalidInput("--from file: lacks the file; write file:SENSORS.csv")
    from pathlib import Path

    from mbkf.io.imu.files import read_imu_session
    from mbkf.stream.file_source import FileSource
    from mbkf.stream.played import played_sensors

    readings = read_imu_session([path], units=parse_units(args.units), rate_hz=args.rate)
    return FileSource(played_sensors(readings, Path(path).stem), args.speed)
