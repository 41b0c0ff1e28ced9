"""Play a capture as a live stream.

Plays markers and plates as Lab Streaming Layer, OptiTrack NatNet or JSON over UDP, in real time, as cameras send them.

Examples:
  mbkf replay walk.c3d --to lsl
  mbkf replay walk.trc --forces grf.mot --to natnet --speed 2
  mbkf replay walk.c3d --to udp --port 15100
  mbkf replay raw.c3d --unlabelled --to lsl --jitter 5 --loss 0.1

Playing starts when a receiver connects, e.g. 'mbkf live --from lsl --subject subject.toml --out result'.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from mbkf.cli.options import (
    CAPTURE_FILES,
    FORCE_FILES,
    add_axes_options,
    axes_options,
    not_negative,
    port,
    positive,
    share,
)

if TYPE_CHECKING:
    from mbkf.stream.played import Played
    from mbkf.stream.replay import Player

NATNET_PORT = 1510
"""Motive's command port."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("trial", metavar="TRIAL", help=f"capture ({CAPTURE_FILES})")
    parser.add_argument(
        "--forces", metavar="FILE", help=f"ground reactions ({FORCE_FILES}); a C3D brings its own plates"
    )
    parser.add_argument("--to", required=True, choices=("lsl", "natnet", "udp"), help="kind of the stream")
    add_playing_options(parser)
    parser.add_argument(
        "--unlabelled",
        action="store_true",
        help="drop the markers' names and shuffle the points (raw captures always are)",
    )
    parser.add_argument(
        "--port",
        type=port,
        metavar="N",
        help="NatNet: command port (default: 1510); udp: the receiver's port (default: 15100)",
    )
    parser.add_argument(
        "--address",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="NatNet: where to listen; udp: where to send (default: this computer)",
    )
    add_axes_options(parser)


def add_playing_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of a stream that is played from a file."""
    parser.add_argument("--speed", type=positive, default=1.0, metavar="X", help="times real time (1)")
    parser.add_argument(
        "--jitter", type=not_negative, default=0.0, metavar="MS", help="delay frames by up to MS milliseconds"
    )
    parser.add_argument(
        "--loss", type=share, default=0.0, metavar="FRACTION", help="share of the frames that is not sent"
    )
    parser.add_argument(
        "--wait", type=not_negative, default=30.0, metavar="S", help="play without a receiver after S (30)"
    )
    parser.add_argument("--name", default="mbkf", metavar="NAME", help="LSL: name of the stream (mbkf)")


def run(args: argparse.Namespace) -> int:
    """Plays the capture once."""
    from mbkf.io.capture import read_capture
    from mbkf.stream.played import played

    capture = read_capture(args.trial, forces=args.forces, **axes_options(args))
    stream = played(capture, args.unlabelled)
    if args.to == "natnet":
        from mbkf.stream.natnet.player import NatNetPlayer

        command = NATNET_PORT if args.port is None else args.port
        return play(args, stream, NatNetPlayer(stream, args.address, command), args.trial)
    if args.to == "udp":
        from mbkf.stream.udp.messages import DEFAULT_PORT
        from mbkf.stream.udp.player import UdpPlayer

        to = DEFAULT_PORT if args.port is None else args.port
        return play(args, stream, UdpPlayer(stream, args.address, to), args.trial)
    from mbkf.stream.lsl.player import LslPlayer

    return play(args, stream, LslPlayer(stream, args.name, args.speed), args.trial)


def play(args: argparse.Namespace, stream: Played, player: Player, file: str) -> int:
    """Plays a stream once and prints the counts of its frames.

    Args:
        args: Options of the command.
        stream: The frames.
        player: The sender, closed afterwards.
        file: Origin of the frames, for the printed line.
    """
    from mbkf.cli.progress import stages
    from mbkf.cli.stopping import stopped_by_signal
    from mbkf.stream.replay import ReplaySettings, replay

    settings = ReplaySettings(args.speed, args.jitter / 1000.0, args.loss, args.wait)
    try:
        with stopped_by_signal() as stop, stages() as report:
            done = replay(stream, player, settings, stop, lambda n, total: report("Playing", n, total))
    finally:
        player.close()
    print(
        f"{file}: {done.sent} frames sent at {stream.stream.rate_hz * args.speed:g} Hz, {done.dropped} left out, "
        f"at most {1e3 * done.latest_s:.1f} ms late"
    )
    return 0
