"""`mbkf replay`: plays a capture as a live stream, as a camera system would send it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.stream.played import Played
    from mbkf.stream.replay import Player

_EPILOG = """\
examples:
  mbkf replay walk.c3d --to lsl
  mbkf replay walk.trc --forces grf.mot --to natnet --speed 2
  mbkf replay raw.c3d --unlabelled --to lsl --jitter 5 --loss 0.1

Playing starts when a receiver connects, e.g. 'mbkf live --from lsl --subject subject.toml --out result'.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.options import CAPTURE_FILES, FORCE_FILES, add_axes_options

    parser = subparsers.add_parser(
        "replay",
        help="plays a capture as a live stream",
        description="Play markers and plates as Lab Streaming Layer or OptiTrack NatNet, in real time.",
        epilog=_EPILOG,
    )
    parser.add_argument("trial", metavar="TRIAL", help=f"capture ({CAPTURE_FILES})")
    parser.add_argument(
        "--forces", metavar="FILE", help=f"ground reactions ({FORCE_FILES}); a C3D brings its own plates"
    )
    parser.add_argument("--to", required=True, choices=("lsl", "natnet"), help="what to play it as")
    parser.add_argument("--speed", type=float, default=1.0, metavar="X", help="times real time (default: 1)")
    parser.add_argument(
        "--jitter", type=float, default=0.0, metavar="MS", help="send frames late by up to this"
    )
    parser.add_argument(
        "--loss", type=float, default=0.0, metavar="FRACTION", help="share of the frames that is not sent"
    )
    parser.add_argument(
        "--unlabelled",
        action="store_true",
        help="drop the markers' names and shuffle the points, as for raw captures anyhow",
    )
    parser.add_argument(
        "--name", default="mbkf", metavar="NAME", help="LSL: name of the stream (default: mbkf)"
    )
    parser.add_argument(
        "--port", type=int, default=1510, metavar="N", help="NatNet: command port (default: 1510)"
    )
    parser.add_argument(
        "--address",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="NatNet: where to listen (default: this computer)",
    )
    parser.add_argument(
        "--wait",
        type=float,
        default=30.0,
        metavar="S",
        help="play without a receiver after this (default: 30)",
    )
    add_axes_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Plays the capture once.

    Raises:
        MbkfError: An input is unusable, or a library is missing.
    """
    from mbkf.cli.options import axes_options, check_positive, check_share
    from mbkf.cli.progress import stages
    from mbkf.cli.stopping import stopped_by_signal
    from mbkf.io.capture import read_capture
    from mbkf.stream.played import played
    from mbkf.stream.replay import ReplaySettings, replay

    check_positive("--speed", args.speed)
    for name, value in (("--jitter", args.jitter), ("--wait", args.wait)):
        check_positive(name, value, or_zero=True)
    check_share("--loss", args.loss)
    capture = read_capture(args.trial, forces=args.forces, **axes_options(args))
    stream = played(capture, args.unlabelled)
    settings = ReplaySettings(args.speed, args.jitter / 1000.0, args.loss, args.wait)
    player = _player(args, stream)
    try:
        with stopped_by_signal() as stop, stages() as report:
            done = replay(stream, player, settings, stop, lambda n, total: report("Playing", n, total))
    finally:
        player.close()
    print(
        f"{args.trial}: {done.sent} frames sent at {stream.stream.rate_hz * args.speed:g} Hz as {args.to}, "
        f"{done.dropped} left out, at most {1e3 * done.latest_s:.1f} ms behind time"
    )
    return 0


def _player(args: argparse.Namespace, stream: Played) -> Player:
    if args.to == "lsl":
        from mbkf.stream.lsl.player import LslPlayer

        return LslPlayer(stream, args.name, args.speed)
    from mbkf.stream.natnet.player import NatNetPlayer

    return NatNetPlayer(stream, args.address, args.port)
