"""Plays a capture through a simulated server: ``python -m benchmarks.streams.serve PROTOCOL FILE``."""

from __future__ import annotations

import argparse
import sys
import threading
from collections.abc import Sequence

from benchmarks.streams.qualisys_server import QtmServer
from benchmarks.streams.vicon_server import ViconServer
from mbkf.io.capture import read_capture
from mbkf.stream.played import played
from mbkf.stream.replay import Player, ReplaySettings, replay


def main(words: Sequence[str]) -> None:
    """Plays it once.

    Args:
        words: Protocol, capture, and options as of ``mbkf replay``.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("protocol", choices=("qualisys", "vicon"))
    parser.add_argument("trial")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--discover-port", type=int)
    parser.add_argument("--forces")
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--jitter", type=float, default=0.0)
    parser.add_argument("--loss", type=float, default=0.0)
    parser.add_argument("--unlabelled", action="store_true")
    args = parser.parse_args(words)
    stream = played(read_capture(args.trial, forces=args.forces), args.unlabelled)
    player: Player
    if args.protocol == "vicon":
        player = ViconServer(stream, port=args.port)
    else:
        player = QtmServer(stream, port=args.port, discover_port=args.discover_port)
    try:
        replay(stream, player, ReplaySettings(args.speed, args.jitter / 1e3, args.loss), threading.Event())
    finally:
        player.close()


if __name__ == "__main__":
    main(sys.argv[1:])
