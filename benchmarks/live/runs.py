"""One live run for the benchmark: `mbkf live` and `mbkf replay` as processes of their own, as a laboratory has them."""

from __future__ import annotations

import json
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import SUBJECT_FILE, read_live_log
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

MARGIN_S = 60.0
"""Beyond the length of the capture, so much time may pass before a run is given up."""

COMPARED = ("q", "v", "a", "tau", "foot_wrench", "angles", "moments", "sd_q", "sd_v", "sd_tau", "predicted_m")
QUATERNION = slice(3, 7)
"""The pelvis' quaternion in a configuration."""

PAGE = re.compile(r"page: (http://\S+)")


@dataclass(frozen=True)
class Trial:
    """What is played.

    Attributes:
        name: For people.
        path: The capture.
        forces: Ground reactions beside it.
        subject: The person's file.
        seconds: Its length.
        unlabelled: Whether its points go without names.
    """

    name: str
    path: Path
    forces: Path | None
    subject: Path
    seconds: float
    unlabelled: bool = False


@dataclass(frozen=True)
class Run:
    """How a run went.

    Attributes:
        report: The contents of live.json.
        folder: With results and log.
        pauses_ms: By how much an idle process woke late on this machine meanwhile.
        work_ms: (n, 2) what a fixed piece of work took there after each pause, and right afterwards once more.
    """

    report: dict[str, Any]
    folder: Path
    pauses_ms: Array
    work_ms: Array = field(default_factory=lambda: np.zeros((0, 2)))


class Wire(NamedTuple):
    """Settings by which a capture is sent and received.

    Attributes:
        receive: Options of ``mbkf live``.
        send: The module that plays it, and its command.
        send_options: Options of that.
    """

    receive: tuple[str, ...]
    send: tuple[str, ...]
    send_options: tuple[str, ...]


def wire_of(protocol: str) -> Wire:
    """A stream of a protocol on this computer, with a name and a port of its own."""
    port, replay = str(free_port()), ("mbkf", "replay")
    if protocol == "lsl":
        name = f"mbkf-benchmark-{uuid.uuid4().hex[:8]}"
        return Wire(("--from", "lsl", "--stream", name), replay, ("--to", "lsl", "--name", name))
    if protocol == "natnet":
        return Wire(("--from", "natnet", "--port", port), replay, ("--to", "natnet", "--port", port))
    if protocol == "udp":
        return Wire(("--from", f"udp:{port}"), replay, ("--to", "udp", "--port", port))
    simulator = ("benchmarks.streams.serve", protocol)
    place = port if protocol == "xsens" else f"127.0.0.1:{port}"
    return Wire(("--from", f"{protocol}:{place}"), simulator, ("--port", port))


class Pauses:
    """A thread that does nothing but wake every few milliseconds, and notes how late it does.

    It then reads a line of JSON twice: where others use the processor's caches meanwhile, the first time takes longer.
    """

    EVERY_S = 0.005
    WORK = json.dumps({str(k): [0.1 * k, 0.2 * k, 0.3 * k] for k in range(80)})

    def __init__(self) -> None:
        self._late: list[float] = []
        self._work: list[tuple[float, float]] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def end(self) -> Array:
        """(n,) how late, ms."""
        self._ended.set()
        self._thread.join()
        return 1e3 * np.array(self._late)

    def work_ms(self) -> Array:
        """(n, 2) how long the work took, ms."""
        return 1e3 * np.array(self._work).reshape(-1, 2)

    def _run(self) -> None:
        while not self._ended.is_set():
            begin = time.perf_counter()
            time.sleep(self.EVERY_S)
            self._late.append(time.perf_counter() - begin - self.EVERY_S)
            self._work.append((self._worked(), self._worked()))

    def _worked(self) -> float:
        begin = time.thread_time()
        json.loads(self.WORK)
        return time.thread_time() - begin


def play(
    trial: Trial,
    protocol: str,
    folder: Path,
    *,
    view: bool = False,
    speed: float = 1.0,
    filter_words: Sequence[str] = ("dynamic",),
    more: Sequence[str | Path] = (),
) -> Run:
    """Plays a trial into a live run.

    Args:
        trial: The capture and its subject.
        protocol: "lsl", "natnet", "udp", or that of a simulator in :mod:`benchmarks.streams`.
        folder: Folder for the results.
        view: Whether a live page is open, too.
        speed: Times real time.
        filter_words: What follows ``--filter``: its name, and options such as a preset.
        more: Further options of ``mbkf live``.

    Raises:
        InvalidInput: One of the commands failed.
    """
    shutil.rmtree(folder, ignore_errors=True)
    wire = wire_of(protocol)
    words: list[str | Path] = ["mbkf", "live", *wire.receive, "--subject", trial.subject]
    words += ["--filter", *filter_words, "--seconds", f"{trial.seconds:.6f}", "--keep-log", "--out", folder]
    words += ["--view"] if view else []
    words += more
    live = _start(words)
    watching = threading.Thread(target=_watch, args=(live.stderr, view), daemon=True)
    watching.start()
    played: list[str | Path] = [*wire.send, trial.path, "--speed", f"{speed:g}", *wire.send_options]
    played += [] if trial.forces is None else ["--forces", trial.forces]
    played += ["--unlabelled"] if trial.unlabelled else []
    replay = _start(played)
    pauses = Pauses()
    try:
        for process, what in ((replay, "replay"), (live, "live")):
            if process.wait(trial.seconds / speed + MARGIN_S) != 0:
                raise InvalidInput(f"mbkf {what} failed on {trial.name}")
    except subprocess.TimeoutExpired as error:
        raise InvalidInput(f"a run of {trial.name} through {protocol} did not end") from error
    finally:
        late = pauses.end()
        for process in (replay, live):
            if process.poll() is None:
                process.kill()
                process.wait()
    report = json.loads((folder / "live.json").read_text(encoding="utf-8"))
    return Run(report, folder, late, pauses.work_ms())


def difference(run: Run) -> float:
    """Largest difference between a run's results and the causal ones of `reconstruct` on the frames it received.

    Relative to the value where that is larger than one; NaN where different samples are known.
    """
    logged = read_live_log(run.folder / LOG_FOLDER)
    start_s = logged.stream.start_time_s + logged.first / logged.stream.rate_hz
    markers = MarkerTrajectories(logged.names, logged.rows["measured_m"], logged.stream.rate_hz, start_s)
    capture = Capture(logged.stream.trial, markers, logged.stream.plates)
    subject = read_subject(run.folder / LOG_FOLDER / SUBJECT_FILE)
    settings = ReconstructSettings(smooth=False, correct_markers=False)
    again = reconstruct(capture, subject, settings=settings)
    return largest_difference(read_reconstruction(run.folder), again)


def largest_difference(
    one: Reconstruction,
    other: Reconstruction,
    names: Sequence[str] = COMPARED,
    part: slice = slice(None),
) -> float:
    """Over quantities in a part of the frames; q and −q of the pelvis' quaternion are one orientation.

    Relative to the value where that is larger than one; NaN where different samples are known.

    Args:
        one: The results.
        other: Those that they are compared with.
        names: The quantities.
        part: The frames.
    """
    values = {name: (getattr(one, name)[part], getattr(other, name)[part]) for name in names}
    if "q" in values:
        values["q"] = on_same_side(*values["q"]), values["q"][1]
    return float(np.max([apart(*both) for both in values.values()]))  # NaN counts, wherever it is


def on_same_side(q: Array, other: Array) -> Array:
    """(T, nq) configurations whose quaternions lie in the hemisphere of others', frame by frame.

    Args:
        q: (T, nq) the configurations.
        other: (T, nq) the others; of another shape they are no measure.
    """
    if q.shape != other.shape:
        return q
    turned = np.array(q)
    turned[np.sum(q[:, QUATERNION] * other[:, QUATERNION], axis=1) < 0.0, QUATERNION] *= -1.0
    return turned


def apart(one: Array, other: Array) -> float:
    """Largest difference, relative to the value where that is larger than one; NaN where different samples are known.

    Args:
        one: The values.
        other: Those that they are compared with.
    """
    if one.shape != other.shape or (np.isnan(one) != np.isnan(other)).any():
        return float("nan")
    return float(np.nanmax(np.abs(one - other) / np.maximum(1.0, np.abs(other)), initial=0.0))


def _start(words: Sequence[str | Path]) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", *map(str, words)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _watch(errors: IO[str] | None, view: bool) -> None:
    """Reads a run's terminal output, and follows its page as a browser does."""
    for line in errors or ():
        found = PAGE.search(line)
        if view and found:
            threading.Thread(target=follow_page, args=(found[1],), daemon=True).start()


def follow_page(url: str) -> None:
    """Receives what a page would, until it ends; returns where nobody serves it.

    Args:
        url: The page's address, token included.
    """
    address, _, query = url.partition("?")
    origin = Origin(address.rstrip("/"))
    stream = f"ws{origin.removeprefix('http')}/frames" + (f"?{query}" if query else "")
    try:
        with connect(stream, origin=origin, max_size=None) as client:
            for _ in client:
                pass
    except (OSError, WebSocketException):
        return


def free_port() -> int:
    """A port of this computer that nobody has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])
