"""Play recorded sensors as a live stream.

Plays recorded inertial sensors as Lab Streaming Layer, in real time, as their receiver sends them.

Examples:
  mbkf imu replay walk.csv
  mbkf imu replay pelvis.csv left_thigh.csv left_shank.csv --speed 2 --jitter 5 --loss 0.02

Playing starts when a receiver connects, e.g. 'mbkf imu live --from lsl --subject subject.toml --out result'.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.imu import add_reading_options, add_together_option, chosen, read_session
from mbkf.cli.replay import add_playing_options, play


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings")
    add_reading_options(parser)
    add_together_option(parser)
    add_playing_options(parser)


def run(args: argparse.Namespace) -> int:
    """Plays the recording once."""
    from mbkf.stream.lsl.player import LslPlayer
    from mbkf.stream.played import played_sensors

    sensors = chosen(read_session(args.files, args), args.sensor)
    stream = played_sensors(sensors, Path(args.files[0]).stem)
    return play(args, stream, LslPlayer(stream, args.name, args.speed), args.files[0])
