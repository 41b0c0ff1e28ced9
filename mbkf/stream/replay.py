"""Plays a capture in real time, as cameras would: at any speed, with jitter and loss on request."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mbkf.stream.played import Played, PlayedFrame

LEAD_S = 0.1
"""The first frame is sent this long after a receiver is connected."""

LINGER_S = 0.5
"""After the last frame, the stream stays open this long, so that all frames arrive."""


class Player(Protocol):
    """Sends frames through a streaming protocol."""

    def listening(self) -> bool:
        """True once a receiver is connected to every part of the stream."""

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame; ``age_s`` is how long ago its time was."""

    def close(self) -> None:
        """Ends the stream."""


@dataclass(frozen=True)
class ReplaySettings:
    """Settings of a replay.

    Attributes:
        speed: Times real time.
        jitter_s: Frames are sent late by up to this, each by another time.
        loss: Share of the frames that are not sent.
        wait_s: Longest wait for a receiver; then the capture is played without one.
        seed: Of jitter and loss.
    """

    speed: float = 1.0
    jitter_s: float = 0.0
    loss: float = 0.0
    wait_s: float = 30.0
    seed: int = 0


@dataclass(frozen=True)
class Replayed:
    """Result of a replay.

    Attributes:
        sent: Frames sent.
        dropped: Frames left out on request.
        latest_s: The largest delay of a frame behind its time, jitter not counted.
    """

    sent: int
    dropped: int
    latest_s: float


def replay(
    played: Played,
    player: Player,
    settings: ReplaySettings,
    stop: threading.Event,
    progress: Callable[[int, int], None] | None = None,
) -> Replayed:
    """Sends all frames, each when its time has come.

    Args:
        played: The capture.
        player: Sends the frames.
        settings: Speed, jitter and loss.
        stop: Set to end early.
        progress: Called with frames done and in all.
    """
    begin = time.perf_counter()
    while not player.listening() and not stop.is_set():
        if time.perf_counter() - begin > settings.wait_s:
            break
        time.sleep(0.01)
    rng = np.random.default_rng(settings.seed)
    frames, rate_hz = len(played), played.stream.rate_hz * settings.speed
    late = rng.uniform(0.0, settings.jitter_s, frames)
    kept = rng.uniform(size=frames) >= settings.loss
    start = time.perf_counter() + LEAD_S
    sent, latest = 0, 0.0
    for frame in played.frames():
        if stop.is_set():
            break
        due = start + frame.number / rate_hz + played.due_after_s / settings.speed + late[frame.number]
        _sleep_until(due, stop)
        now = time.perf_counter()
        latest = max(latest, now - due)
        if kept[frame.number]:
            player.send(frame, played.due_after_s / settings.speed + float(late[frame.number]))
            sent += 1
        if progress is not None:
            progress(frame.number + 1, frames)
    stop.wait(LINGER_S)
    return Replayed(sent, int(frames - kept.sum()), latest)


def _sleep_until(due: float, stop: threading.Event) -> None:
    while not stop.is_set():
        left = due - time.perf_counter()
        if left <= 0.0:
            return
        time.sleep(min(left, 0.1))
