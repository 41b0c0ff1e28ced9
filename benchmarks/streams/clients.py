"""Rows: clients that others wrote read the simulated QTM and the simulated DataStream server.

They are installed in an environment of their own, whose interpreter ``MBKF_STREAM_CLIENTS`` names:
``python -m venv DIR && DIR/bin/pip install qtm-rt==3.1.0 motioncapture==1.1 pyvicon-datastream==0.2.4``; the last one
builds the DataStream SDK and needs Boost. Vicon's clients know port 801 only, which a user may have to be allowed.
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
from benchmarks.streams.vicon_server import BODY as SUBJECT_NAME
from benchmarks.streams.vicon_server import ViconServer
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.stream.played import Played, played
from mbkf.stream.qualisys.client import BASE_PORT
from mbkf.stream.vicon.client import PORT
from mbkf.trial.synth import synthesise, write_folder

VARIABLE = "MBKF_STREAM_CLIENTS"
FRAMES, SECONDS = 40, 1.0
PATIENCE_S = 60.0
SINGLE_MM, SINGLE_N = 2e-3, 2e-3
"""Single precision of coordinates up to 10 m, and of forces up to 10 kN."""

ROWS = {
    "qualisys": (
        "read by qtm-rt: markers, mm",
        "read by qtm-rt: forces, N",
        "read by motioncapture: a body's place, mm",
    ),
    "vicon": (
        "read by pyvicon-datastream: markers, mm",
        "read by motioncapture: a subject's place, mm",
    ),
}
"""Rows by protocol."""

PROGRAM = Path(__file__).with_name("third_party.py")


def client_rows(context: Context, protocol: str) -> Iterator[Check]:
    """Difference of each client's numbers from the capture; left out where none is installed."""
    names = ROWS[protocol]
    interpreter = os.environ.get(VARIABLE)
    if interpreter is None:
        yield from (
            left_out(name, f"needs {VARIABLE}, the interpreter of an environment with it") for name in names
        )
        return
    subject, walk = synthesise("walk", seconds=SECONDS, rate_hz=100.0)
    write_folder(subject, walk, context.out / "clients")
    capture = played(read_capture(context.out / "clients" / "trial.c3d"))
    yield from (_qualisys if protocol == "qualisys" else _vicon)(interpreter, capture)


def _qualisys(interpreter: str, capture: Played) -> Iterator[Check]:
    frames, names = list(capture.frames()), ROWS["qualisys"]
    found = _read(interpreter, "qtm-rt", capture)
    if found is None:
        yield from (left_out(name, "qtm-rt is not installed there") for name in names[:2])
    else:
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
    yield _body(names[2], _read(interpreter, "motioncapture", capture), BODY, capture)


def _vicon(interpreter: str, capture: Played) -> Iterator[Check]:
    names, listed = ROWS["vicon"], capture.stream.marker_names
    found = _read(interpreter, "pyvicon", capture)
    if found is None:
        yield left_out(names[0], "pyvicon-datastream is not installed there")
    else:
        apart = [
            float(np.abs(np.array(one["markers"][name]) - 1e3 * capture.markers_m[one["frame"], k]).max())
            for one in found
            for k, name in enumerate(listed)
            if one["markers"][name] is not None
        ]
        yield Check(names[0], max(apart), SINGLE_MM, "<=")
    yield _body(names[1], _read(interpreter, "motioncapture-vicon", capture), SUBJECT_NAME, capture)


def _body(row: str, found: list[dict[str, Any]] | None, body: str, capture: Played) -> Check:
    """The row of a body that stands in the middle of the markers; frames before the first are without it."""
    if found is None:
        return left_out(row, "motioncapture is not installed there")
    middles = np.nanmean(capture.markers_m, axis=1)
    places = [np.array(one[body]) for one in found if body in one]
    apart = [1e3 * float(np.linalg.norm(middles - place, axis=1).min()) for place in places]
    return Check(row, max(apart) if apart else np.inf, SINGLE_MM, "<=")


def _read(interpreter: str, client: str, capture: Played) -> list[dict[str, Any]] | None:
    """The frames that a client reads while the simulator plays the capture again and again.

    None where the client is not installed.

    Raises:
        InvalidInput: It reads none.
    """
    vicon = client in ("pyvicon", "motioncapture-vicon")
    server: QtmServer | ViconServer
    if vicon:
        server = ViconServer(capture, port=PORT)
    else:
        server = QtmServer(capture, port=BASE_PORT if client == "motioncapture" else 0)
    place = "127.0.0.1" if client != "qtm-rt" else str(server.port)
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
    if told.get("missing"):
        return None
    if not told.get("frames"):
        raise InvalidInput(
            f"{client} reads nothing of the simulator: {told.get('failed', ran.stderr[-300:])}"
        )
    frames: list[dict[str, Any]] = told["frames"]
    return frames
