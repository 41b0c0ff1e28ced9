"""Faults of streams over LSL and NatNet: no thread of a live run may die, and every frame must be accounted for.

    python -m benchmarks.robustness.stream_faults FOLDER PROTOCOL:FAULT:SEED …

plays a walk into live runs, each with one fault in its middle, and prints what became of each in a line of its own.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.robustness.cameras import CAMERAS, Camera
from benchmarks.robustness.faults import FAULTS, Fault, Nonsense, Pause, Restart, Send, Step
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.subject import read_subject
from mbkf.pipelines.reconstruct import ReconstructSettings
from mbkf.pipelines.synth import synthesise, write_folder
from mbkf.stream.played import Played, played
from mbkf.stream.run.session import LiveSession

TIMES, QUICK_TIMES = 3, 1
WORKERS = 2
CHUNK = 8
"""So many runs a process makes."""

SECONDS, RATE_HZ = 2.0, 100.0
BEGINS, ENDS = 70, 135
"""Frames between which the fault is."""

WAIT_S, LINGER_S, HANG_S = 20.0, 0.4, 60.0
PLACES = ("written", "not_written", "overwritten", "late", "unanswered")
"""Where a frame that came may be, as live.json counts them."""

HELD, DEAD, LOST, HUNG = "held", "a thread died", "frames not accounted for", "hung"


def rows(folder: Path, quick: bool) -> list[Check]:
    """All faults over all protocols, several times each.

    Args:
        folder: For the files.
        quick: Whether once only.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_folder(*synthesise("walk", seconds=SECONDS, rate_hz=RATE_HZ), folder / "walk")
    first = time.time_ns() % 2**31
    times = QUICK_TIMES if quick else TIMES
    words = [
        f"{protocol}:{fault}:{first + k}" for k in range(times) for protocol in CAMERAS for fault in FAULTS
    ]
    chunks = [words[at : at + CHUNK] for at in range(0, len(words), CHUNK)]
    found: dict[str, str] = {}
    with ThreadPoolExecutor(WORKERS) as pool:
        for some in pool.map(partial(_in_a_process, folder), chunks):
            found |= some
    return told(found)


def told(found: dict[str, str]) -> list[Check]:
    """What became of the runs, by their words."""
    count = {kind: sum(outcome.startswith(kind) for outcome in found.values()) for kind in (DEAD, LOST, HUNG)}
    return [
        information(f"runs with one of {len(FAULTS)} stream faults", float(len(found))),
        Check("of which a thread died", float(count[DEAD]), 0.0, "<="),
        Check("of which frames were not accounted for", float(count[LOST]), 0.0, "<="),
        Check("of which the process hung or died", float(count[HUNG]), 0.0, "<="),
        *(information(f"{word}: {outcome}", 1.0) for word, outcome in found.items() if outcome != HELD),
    ]


def _in_a_process(folder: Path, words: Sequence[str]) -> dict[str, str]:
    command = [sys.executable, "-m", "benchmarks.robustness.stream_faults", str(folder), *words]
    found: dict[str, str] = {}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=HANG_S * len(words), check=False
        )
        lines = done.stdout.splitlines()
    except subprocess.TimeoutExpired as late:
        lines = (late.stdout or b"").decode().splitlines()
    for line in lines:
        if line.startswith("end "):
            word, _, outcome = line.removeprefix("end ").partition(" = ")
            found[word] = outcome
    return {word: found.get(word, HUNG) for word in words}


def main(words: Iterable[str]) -> None:
    """Makes the runs that the words name."""
    folder, *asked = words
    walk = Path(folder) / "walk"
    capture, subject = played(read_capture(walk / "trial.c3d")), read_subject(walk / "subject.toml")
    dead: list[str] = []
    threading.excepthook = lambda args: dead.append(f"{args.exc_type.__name__} in {args.thread}")
    for word in asked:
        protocol, fault, seed = word.split(":")
        out = Path(folder) / f"{protocol}-{fault.replace(' ', '-')}-{seed}"
        dead.clear()
        camera = CAMERAS[protocol](capture)
        settings = ReconstructSettings(smooth=False, correct_markers=False)
        session = LiveSession(camera.source(), subject, settings, out, protocol)
        outcome = run(session, camera, list(steps(capture, FAULTS[fault], int(seed))), capture, dead)
        print(f"end {word} = {outcome}", flush=True)


def run(session: LiveSession, camera: Camera, sent: Sequence[Step], capture: Played, dead: list[str]) -> str:
    """What becomes of a live run with a fault in its middle.

    Args:
        session: The run, not connected yet.
        camera: What it follows.
        sent: What the camera does.
        capture: What it shows.
        dead: Threads that died of an error meanwhile.
    """
    stop, finished = threading.Event(), threading.Event()
    sender = threading.Thread(target=_play, args=(camera, capture, sent, stop, finished), name="camera")
    sender.start()
    try:
        if not session.connect(stop, WAIT_S):
            return f"{HUNG}: never connected"
        outcome = session.run(stop)
    except MbkfError as error:
        return f"{HUNG}: {error}"
    finally:
        finished.set()
        stop.set()
        sender.join()
        camera.close()
    report = outcome.report
    if outcome.failed or dead:
        return f"{DEAD}: {report['ended_by']} {dead}"
    counts = {name: report[f"frames_{name}"] for name in PLACES}
    if report["frames_in"] != sum(counts.values()):  # type: ignore[arg-type]
        return f"{LOST}: {report['frames_in']} came, {counts}"
    came, lost = int(str(report["frames_in"])), int(str(report["frames_lost_on_the_way"]))
    whole = not any(isinstance(step, Restart) for step in sent)
    if came > camera.sent or (whole and came + lost < camera.sent):
        return f"{LOST}: {came} came of {camera.sent} sent, {lost} are told lost"
    return HELD


def _play(
    camera: Camera,
    capture: Played,
    sent: Sequence[Step],
    stop: threading.Event,
    finished: threading.Event,
) -> None:
    """Does what a camera is to do as soon as somebody listens, and ends the run then.

    Args:
        camera: The camera.
        capture: What it shows.
        sent: What it does.
        stop: Set at the end.
        finished: Set when the run has ended.
    """
    until = time.monotonic() + WAIT_S
    while not camera.listening() and not finished.is_set() and time.monotonic() < until:
        time.sleep(0.01)
    begin, late = time.perf_counter(), 0.0
    for step in sent:
        if finished.is_set():
            return
        match step:
            case Pause(seconds):
                time.sleep(seconds)
                late += seconds
            case Nonsense(packet, foreign):
                camera.nonsense(packet, foreign)
            case Restart(seconds, returns, renamed):
                camera.restart(None)
                time.sleep(seconds)
                late += seconds
                if returns:
                    camera.restart(_renamed(capture) if renamed else capture)
            case Send(frame, number):
                time.sleep(max(0.0, begin + late + frame.number / RATE_HZ - time.perf_counter()))
                camera.frame(frame, number)
    time.sleep(LINGER_S)
    stop.set()


def steps(capture: Played, fault: Fault, seed: int) -> Iterator[Step]:
    """What is sent: all frames, those in the middle as the fault has it.

    Args:
        capture: The frames.
        fault: The fault.
        seed: Of its chance.
    """
    frames = list(capture.frames())
    yield from (Send(frame, frame.number) for frame in frames[:BEGINS])
    yield from fault(frames[BEGINS:ENDS], np.random.default_rng(seed))
    yield from (Send(frame, frame.number) for frame in frames[ENDS:])


def _renamed(capture: Played) -> Played:
    names = tuple(f"other {name}" for name in capture.stream.marker_names)
    return replace(capture, stream=replace(capture.stream, marker_names=names))


if __name__ == "__main__":
    main(sys.argv[1:])
