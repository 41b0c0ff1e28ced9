"""Sends a capture as JSON lines and notes when: ``python -m benchmarks.streams.sender FILE PORT TIMES.json``."""

from __future__ import annotations

import json
import sys
import threading
import time
from pathlib import Path

from mbkf.io.capture import read_capture
from mbkf.stream.played import Played, PlayedFrame, played
from mbkf.stream.replay import ReplaySettings, replay
from mbkf.stream.udp.player import UdpPlayer


class TimedPlayer(UdpPlayer):
    """A player that keeps when it sent each frame, on the clock of ``time.perf_counter``."""

    def __init__(self, played: Played, address: str, port: int) -> None:
        """A player.

        Args:
            played: The capture.
            address: Address of the receiver.
            port: Its port.
        """
        super().__init__(played, address, port)
        self.times_s: dict[int, float] = {}

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame."""
        self.times_s[frame.number] = time.perf_counter()
        super().send(frame, age_s)


def main(file: str, port: str, times: str) -> None:
    """Plays it once, and writes the times.

    Args:
        file: The capture.
        port: The receiver's port.
        times: File for the times.
    """
    stream = played(read_capture(file))
    player = TimedPlayer(stream, "127.0.0.1", int(port))
    replay(stream, player, ReplaySettings(), threading.Event())
    player.close()
    Path(times).write_text(json.dumps(player.times_s), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
