"""Rows: latency of results out, from the sending of a frame to the arrival of its result, for each way out.

A process of its own sends frames as JSON lines and notes when; `mbkf live` answers; a thread here receives its results
in one way: LSL, WebSocket, JSON or OSC. Clocks are one: ``time.perf_counter`` counts for the whole computer.
"""

from __future__ import annotations

import json
import socket
import struct
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import connect

from benchmarks.checks import Check, Context, information
from benchmarks.live.runs import MARGIN_S, Pauses, Trial, free_port
from benchmarks.streams.scenes import belt_walk
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.stream.libraries import lsl
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import read_live_log

SECONDS, QUICK_SECONDS, RATE_HZ = 10.0, 4.0, 100.0
START_FRAMES = 100
"""Frames at the beginning that do not count: the filter catches up with its start."""

HERE, LARGEST, LOOK_S = "127.0.0.1", 65536, 0.5
OSC_FRAME = b"/mbkf/frame\0,i\0\0"

Arrivals = dict[int, float]
"""When the result of each frame arrived, by its number since the first one."""


def out_rows(context: Context) -> Iterator[Check]:
    """Median and 99th percentile of each way, and how late an idle process woke meanwhile."""
    trial = belt_walk(context.out, QUICK_SECONDS if context.quick else SECONDS, RATE_HZ)
    for way in WAYS:
        sent, found, pauses_ms = measured(trial, context.out / f"results-{way}", way)
        late = latencies_ms(sent, found)
        yield information(f"results out as {way}: frames", len(late))
        for word, percent in (("median", 50.0), ("99th percentile", 99.0)):
            value = float(np.percentile(late, percent)) if len(late) else np.nan
            yield information(f"results out as {way}: frame sent to result received, {word}, ms", value)
            idle = float(np.percentile(pauses_ms, percent))
            yield information(f"results out as {way}: an idle process woke late, {word}, ms", idle)


def latencies_ms(sent: Arrivals, found: Arrivals) -> Array:
    """(n,) latencies of the frames that were sent and whose results arrived, but for those at the start.

    Args:
        sent: When frames were sent, by number.
        found: When their results arrived.
    """
    return np.array(
        [1e3 * (found[k] - sent[k]) for k in sorted(found) if k >= START_FRAMES and k in sent], dtype=float
    )


def measured(trial: Trial, folder: Path, way: str) -> tuple[Arrivals, Arrivals, Array]:
    """When frames were sent, when their results arrived, by number since the run's first frame, and idle delays in ms.

    Args:
        trial: The capture and its subject.
        folder: Folder for the results.
        way: One of :data:`WAYS`.

    Raises:
        InvalidInput: One of the commands failed.
    """
    option, receive = WAYS[way]
    place = f"mbkf-benchmark-{uuid.uuid4().hex[:8]}" if option == "--publish" else str(free_port())
    found, done, port = dict[int, float](), threading.Event(), free_port()
    receiver = threading.Thread(target=receive, args=(place, found, done), daemon=True)
    receiver.start()
    words = ["mbkf", "live", "--from", f"udp:{port}", "--subject", trial.subject, option, place, "--keep-log"]
    words += ["--seconds", f"{trial.seconds:.6f}", "--out", folder, "--overwrite"]
    times = folder.with_suffix(".json")
    sender = ["benchmarks.streams.sender", str(trial.path), str(port), str(times)]
    running = [
        subprocess.Popen([sys.executable, "-m", *map(str, one)], stdout=subprocess.DEVNULL)
        for one in (words, sender)
    ]
    pauses = Pauses()
    try:
        if any(one.wait(trial.seconds + MARGIN_S) != 0 for one in running):
            raise InvalidInput("the run that sends results out failed")
    finally:
        done.set()
        for process in running:
            process.kill()
            process.wait()
    receiver.join()
    first = read_live_log(folder / LOG_FOLDER).first
    sent = {int(k) - first: at_s for k, at_s in json.loads(times.read_text(encoding="utf-8")).items()}
    return sent, found, pauses.end()


def _from_lsl(name: str, found: Arrivals, done: threading.Event) -> None:
    library: Any = lsl()
    streams: list[Any] = []
    while not streams and not done.is_set():
        streams = library.resolve_byprop("name", name, 1, LOOK_S)
    if not streams:
        return
    inlet, channels = library.StreamInlet(streams[0]), streams[0].channel_count()
    while not done.is_set():
        sample, _ = inlet.pull_sample(LOOK_S)
        if sample is not None:
            found.setdefault(int(sample[channels - 3]), time.perf_counter())


def _from_websocket(port: str, found: Arrivals, done: threading.Event) -> None:
    while not done.is_set():
        try:
            with connect(f"ws://{HERE}:{port}/", max_size=None) as client:
                for message in client:
                    at_s, fields = time.perf_counter(), json.loads(message)
                    if "frame" in fields:
                        found.setdefault(fields["frame"], at_s)
        except OSError:  # nobody serves yet
            time.sleep(LOOK_S / 5.0)


def _from_datagrams(
    number_of: Callable[[bytes], int | None], port: str, found: Arrivals, done: threading.Event
) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind((HERE, int(port)))
        one.settimeout(LOOK_S)
        while not done.is_set():
            try:
                data = one.recv(LARGEST)
            except TimeoutError:
                continue
            at_s, number = time.perf_counter(), number_of(data)
            if number is not None:
                found.setdefault(number, at_s)


def _of_json(data: bytes) -> int | None:
    number: int | None = json.loads(data).get("frame")
    return number


def _of_osc(data: bytes) -> int | None:
    at = data.find(OSC_FRAME)
    return None if at < 0 else int(struct.unpack_from(">i", data, at + len(OSC_FRAME))[0])


WAYS: dict[str, tuple[str, Callable[[str, Arrivals, threading.Event], None]]] = {
    "LSL": ("--publish", _from_lsl),
    "WebSocket": ("--websocket", _from_websocket),
    "JSON": ("--send-json", partial(_from_datagrams, _of_json)),
    "OSC": ("--send-osc", partial(_from_datagrams, _of_osc)),
}
"""Option of each way out, and what receives: place, arrivals, and the end."""
