"""Rows: clients that others wrote read the simulated QTM.

They are installed in an environment of their own, whose interpreter ``MBKF_STREAM_CLIENTS`` names:
``python -m venv DIR && DIR/bin/pip install qtm-rt==3.1.0 motioncapture==1.1``.
"""

from __future__ import annotations

import json
import os
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.checks import Check, Context, left_out
from benchmarks.streams.qualisys_server import BODY, QtmServer
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.stream.played import Played, played
from mbkf.stream.qualisys.client import BASE_PORT
from mbkf.trial.synth import synthesise, write_folder

VARIABLE = "MBKF_STREAM_CLIENTS"
FRAMES, SECONDS = 40, 1.0
PATIENCE_S = 60.0
SINGLE_MM, SINGLE_N = 2e-3, 2e-3
"""Single precision of coordinates up to 10 m, and of forces up to 10 kN."""

PROGRAM = Path(__file__).with_name("third_party.py")


def client_rows(context: Context) -> Iterator[Check]:
    """Difference of each client's numbers from the capture; left out where none is installed."""
    names = (
        "read by qtm-rt: markers, mm", "read by qtm-rt: forces, N", "read by motioncapture: a body's place, mm"
    )  # fmt: skip
    interpreter = os.environ.get(VARIABLE)
    if interpreter is None:
        yield from (
            left_out(name, f"needs {VARIABLE}, the interpreter of an environment with it") for name in names
        )
        return
    subject, walk = synthesise("walk", seconds=SECONDS, rate_hz=100.0)
    write_folder(subject, walk, context.out / "clients")
    capture = played(read_capture(context.out / "clients" / "trial.c3d"))
    frames = list(capture.frames())
    found = _read(interpreter, "qtm-rt", capture)
    markers = max(
        float(np.nanmax(np.abs(np.array(one["markers"])[:, :3] - 1e3 * capture.markers_m[one["frame"]])))
        for one in found
    )
    vertical = max(
        abs(sample[2] - frames[one["frame"]].plates.wrench[row, k, 2])
        for one in found
        for k, samples in enumerate(one["forces"])
        for row, sample in enumerate(samples)
    )
    yield Check(names[0], markers, SINGLE_MM, "<=")
    yield Check(names[1], float(vertical), SINGLE_N, "<=")
    middles = np.nanmean(capture.markers_m, axis=1)
    places = [np.array(one[BODY]) for one in _read(interpreter, "motioncapture", capture)]
    apart = [1e3 * float(np.linalg.norm(middles - place, axis=1).min()) for place in places]
    yield Check(names[2], max(apart), SINGLE_MM, "<=")


def _read(interpreter: str, client: str, capture: Played) -> list[dict[str, Any]]:
    """The frames that a client reads while the simulator plays the capture again and again.

    Raises:
        InvalidInput: It reads none.
    """
    server = QtmServer(capture, port=BASE_PORT if client == "motioncapture" else 0)
    place = "127.0.0.1" if client == "motioncapture" else str(server.port)
    done = threading.Event()

    def play() -> None:
        while not done.is_set():
            for frame in capture.frames():
                server.send(frame, 0.0)
                time.sleep(1.0 / capture.stream.rate_hz)

    thread = threading.Thread(target=play, daemon=True)
    thread.start()
    try:
        words = [interpreter, str(PROGRAM), client, place, str(FRAMES)]
        ran = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    finally:
        done.set()
        thread.join()
        server.close()
    told = json.loads(ran.stdout) if ran.stdout.strip() else {}
    if not told.get("frames"):
        raise InvalidInput(
            f"{client} reads nothing of the simulator: {told.get('failed', ran.stderr[-300:])}"
        )
    frames: list[dict[str, Any]] = told["frames"]
    return frames
