"""A live run that goes on and on, with page, results out and a fault every while: nothing may be lost or grow.

`mbkf live` is a process of its own and follows a person who squats again and again over LSL; a client receives its
page, another one its results. Each fault is one of :mod:`benchmarks.robustness.faults`, chosen at random.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from benchmarks.checks import Check, information, within
from benchmarks.live.runs import PAGE, follow_page
from benchmarks.robustness.cameras import LslCamera
from benchmarks.robustness.faults import FAULTS, Nonsense, Pause, Restart, Send
from benchmarks.robustness.stream_faults import PLACES
from mbkf.io.capture import read_capture
from mbkf.pipelines.synth import synthesise, write_folder
from mbkf.stream.played import Played, PlayedFrame, played

SECONDS, RATE_HZ = 5.0, 100.0
FAULT_EVERY, FAULT_FRAMES = 1500, 65
"""So many frames lie between the beginnings of faults, and so many are in one."""

LEFT_OUT = ("gone for good", "back with other markers")
"""Faults that end a run, or all that it could still follow."""

WARM_S, LOOK_S, END_S = 20.0, 1.0, 120.0
GROWTH = 0.05
"""By how much of itself the memory may grow or shrink once it is warm."""

RESULTS = re.compile(r"results: (ws://\S+)")


def rows(folder: Path, minutes: float) -> list[Check]:
    """Frames and memory of a run of so many minutes.

    Args:
        folder: For the files.
        minutes: How long.
    """
    walk = folder / "squat"
    write_folder(*synthesise("squat", seconds=SECONDS, rate_hz=RATE_HZ), walk)
    capture = played(read_capture(walk / "trial.c3d"))
    camera, out = LslCamera(capture), folder / "run"
    words = ["live", "--from", "lsl", "--stream", camera.name, "--subject", str(walk / "subject.toml")]
    words += ["--view", "--websocket", "0", "--out", str(out)]
    live = subprocess.Popen(
        [sys.executable, "-m", "mbkf", *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "BROWSER": "true"},
    )  # fmt: skip
    threading.Thread(target=_watch, args=(live,), daemon=True).start()
    memory = _play(camera, capture, live, minutes)
    live.send_signal(signal.SIGINT)
    code = live.wait(END_S)
    camera.close()
    return told(json.loads((out / "live.json").read_text(encoding="utf-8")), camera.sent, memory, code)


def told(report: dict[str, float], sent: int, memory: list[float], code: int) -> list[Check]:
    """What became of the frames, and of the memory.

    Args:
        report: The contents of live.json.
        sent: Frames sent.
        memory: Memory of the process, MB, once a second.
        code: Its exit code.
    """
    came = report["frames_in"]
    astray = abs(came - sum(report[f"frames_{name}"] for name in PLACES)) + max(0.0, came - sent)
    warm = memory[round(WARM_S / LOOK_S) :]
    growth = warm[-1] / warm[0] if len(warm) > 1 else float("nan")
    return [
        information("live: frames sent", float(sent)),
        information("live: frames written", float(report["frames_written"])),
        information("live: frames told lost", float(report["frames_lost"])),
        Check("live: frames not accounted for", float(astray), 0.0, "<="),
        Check("live: exit code", float(code), 0.0, "<="),
        information("live: memory at the end", memory[-1] if memory else float("nan"), "MB"),
        *within("live: memory at the end over that when warm", growth, 1.0 - GROWTH, 1.0 + GROWTH),
    ]


def _play(camera: LslCamera, capture: Played, live: subprocess.Popen[str], minutes: float) -> list[float]:
    """Sends frames with faults until the time is over; returns the memory of the live run, MB."""
    while not camera.listening() and live.poll() is None:
        time.sleep(0.02)
    rng, memory = np.random.default_rng(time.time_ns()), []
    begin = time.perf_counter()
    looked = late = 0.0
    for step in steps(capture, rng):
        now = time.perf_counter() - begin
        if now > 60.0 * minutes or live.poll() is not None:
            break
        if now - looked >= LOOK_S:
            looked = now
            memory.append(memory_mb(live.pid))
        match step:
            case Pause(seconds):
                time.sleep(seconds)
                late += seconds
            case Restart(seconds):
                camera.restart(None)
                time.sleep(seconds)
                late += seconds
                camera.restart(capture)
            case Nonsense():
                continue
            case Send(frame, number):
                time.sleep(max(0.0, begin + late + frame.number / RATE_HZ - time.perf_counter()))
                camera.frame(frame, number)
    return memory


def steps(capture: Played, rng: np.random.Generator) -> Iterator[Send | Pause | Nonsense | Restart]:
    """What is sent: the capture again and again, and a fault every while.

    Args:
        capture: The frames.
        rng: Chooses faults.
    """
    names = [name for name in FAULTS if name not in LEFT_OUT]
    held: list[PlayedFrame] = []
    for frame in endless(capture):
        if frame.number % FAULT_EVERY < FAULT_EVERY - FAULT_FRAMES:
            yield Send(frame, frame.number)
            continue
        held.append(frame)
        if len(held) == FAULT_FRAMES:
            yield from FAULTS[str(rng.choice(names))](held, rng)
            held = []


def endless(capture: Played) -> Iterator[PlayedFrame]:
    """The frames of a capture again and again, counted on, as their plates' samples are."""
    frames = list(capture.frames())
    ratio = round(capture.stream.plate_rate_hz / capture.stream.rate_hz)
    each = len(frames) - 2  # the first and the last one have another number of samples
    number = 0
    while True:
        for frame in frames[1 : each + 1]:
            index = number * ratio + np.arange(len(frame.plates.index))
            yield replace(frame, number=number, plates=replace(frame.plates, index=index))
            number += 1


def memory_mb(process: int) -> float:
    """Memory that a process has at present, MB; NaN where the system does not tell."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except (OSError, IndexError):
        return float("nan")
    import resource

    return pages * resource.getpagesize() / 1e6


def _watch(live: subprocess.Popen[str]) -> None:
    """Follows page and results as soon as their addresses are printed."""
    assert live.stderr is not None
    for line in live.stderr:
        for pattern, follow in ((PAGE, follow_page), (RESULTS, _listen)):
            if found := pattern.search(line):
                threading.Thread(target=follow, args=(found[1],), daemon=True).start()


def _listen(url: str) -> None:
    try:
        with connect(url, max_size=None) as client:
            for _ in client:
                pass
    except (OSError, WebSocketException):
        return
