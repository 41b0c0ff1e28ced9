"""`mbkf imu replay`: plays recorded inertial sensors as a live stream, as their receiver would send them."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  mbkf imu replay walk.csv
  mbkf imu replay pelvis.csv left_thigh.csv left_shank.csv --speed 2 --jitter 5 --loss 0.02

Playing starts when a receiver connects, e.g. 'mbkf imu live --from lsl --subject subject.toml --out result'.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.imu import add_reading_options

    parser = subparsers.add_parser(
        "replay",
        help="plays recorded sensors as a live stream",
        description="Play recorded inertial sensors as Lab Streaming Layer, in real time.",
        epilog=_EPILOG,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="inertial readings")
    add_reading_options(parser)
    parser.add_argument(
        "--started-together",
        action="store_true",
        help="several files: they started at the same moment, whatever their clocks tell",
    )
    parser.add_argument("--speed", type=float, default=1.0, metavar="X", help="times real time (default: 1)")
    parser.add_argument(
        "--jitter", type=float, default=0.0, metavar="MS", help="send frames late by up to this"
    )
    parser.add_argument(
        "--loss", type=float, default=0.0, metavar="FRACTION", help="share of the frames that is not sent"
    )
    parser.add_argument("--name", default="mbkf", metavar="NAME", help="name of the stream (default: mbkf)")
    parser.add_argument(
        "--wait", type=float, default=30.0, metavar="S", help="wait so long for a receiver (default: 30)"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Plays the recording once.

    Raises:
        MbkfError: An input is unusable, or a library is missing.
    """
    from pathlib import Path

    from mbkf.cli.imu import read_session
    from mbkf.cli.options import check_positive, check_share
    from mbkf.cli.progress import stages
    from mbkf.cli.stopping import stopped_by_signal
    from mbkf.stream.lsl.player import LslPlayer
    from mbkf.stream.played import played_sensors
    from mbkf.stream.replay import ReplaySettings, replay

    check_positive("--speed", args.speed)
    for name, value in (("--jitter", args.jitter), ("--wait", args.wait)):
        check_positive(name, value, or_zero=True)
    check_share("--loss", args.loss)
    stream = played_sensors(read_session(args.files, args), Path(args.files[0]).stem)
    settings = ReplaySettings(args.speed, args.jitter / 1000.0, args.loss, args.wait)
    player = LslPlayer(stream, args.name, args.speed)
    try:
        with stopped_by_signal() as stop, stages() as report:
            done = replay(stream, player, settings, stop, lambda n, total: report("Playing", n, total))
    finally:
        player.close()
    print(
        f"{args.files[0]}: {done.sent} frames sent at {stream.stream.rate_hz * args.speed:g} Hz, "
        f"{done.dropped} left out, at most {1e3 * done.latest_s:.1f} ms behind time"
    )
    return 0
