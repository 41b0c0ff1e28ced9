"""A long live run: a treadmill walk through LSL, lap after lap, each with a fault of its own; its results are read.

The run is a process of its own, ended as Ctrl-C ends it; page and WebSocket are read all the time. Its memory must not
grow once it is warm, and each frame received must be written or counted under one reason why it was not.
"""

from __future__ import annotations

import json
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import IO

import numpy as np
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from benchmarks.checks import Check, Context, information
from benchmarks.robustness.stream_child import ACCOUNTS
from benchmarks.robustness.stream_kinds import KINDS, LSL
from benchmarks.robustness.stream_schedule import Schedule, Sent
from benchmarks.robustness.stream_wire import LslWire
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.stream.played import Played, played
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import read_live_log
from mbkf.trial.synth import synthesise, write_folder

LAP_S = 6.0
WARM_SHARE, WARM_S = 1.0 / 3.0, 120.0
"""The run is warm after this share of its time, and after so long at most."""

GROWTH = 0.05
"""Most by which a warm run's memory may differ from what it was when it became warm."""

END_S = 300.0
"""The results of a run may take so long."""

FINAL = {"stream ends in a frame", "stream returns with other markers", "plates return with other channels"}
"""Faults after which nothing or another stream follows."""

_PAGE = re.compile(r"(?:page|results): (\S+)")


def soak_rows(context: Context) -> Iterator[Check]:
    """The rows of a long run.

    Raises:
        InvalidInput: The time is not positive, or the run failed.
    """
    minutes = context.minutes
    if minutes is None or not minutes > 0.0:
        raise InvalidInput(f"--minutes {minutes}: give a positive time")
    folder = context.out / "soak"
    shutil.rmtree(folder, ignore_errors=True)
    subject, made = synthesise("belt_walk", seconds=LAP_S, rate_hz=100.0)
    write_folder(subject, made, folder)
    name = f"mbkf-soak-{time.time_ns()}"
    walk = played(read_capture(folder / "trial.c3d"))
    wire = LslWire(walk, name, counted=True)
    words = ["live", "--from", "lsl", "--stream", name, "--subject", str(folder / "subject.toml"), "--view"]
    words += ["--websocket", "0", "--keep-log", "--out", str(folder / "out")]
    run = subprocess.Popen(
        [sys.executable, "-m", "mbkf", *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    readers = Readers(run.stderr)
    memory = Memory(run.pid, 60.0 * minutes)
    try:
        laps = Laps(walk, wire, seed=time.time_ns() % 2**31)
        laps.play(60.0 * minutes, run)
        memory.end()
        run.send_signal(signal.SIGINT)
        code = run.wait(END_S)
    except subprocess.TimeoutExpired as error:
        raise InvalidInput("the soak run did not end") from error
    finally:
        run.kill()
        wire.close()
    yield from _rows(folder / "out", code, laps, memory, readers, minutes)


class Laps:
    """Plays a walk again and again.

    Attributes:
        sent: Frames sent.
        faults: How often each fault was played.
    """

    def __init__(self, walk: Played, wire: LslWire, seed: int) -> None:
        """No lap is played yet.

        Args:
            walk: The walk.
            wire: The player.
            seed: What the faults are drawn from.
        """
        self._walk, self._wire, self._rng = walk, wire, np.random.default_rng(seed)
        self._names = [
            name
            for name, kind in KINDS.items()
            if LSL in kind.protocols and name not in FINAL and _counted(kind.fault, walk)
        ]
        self.sent = 0
        self.faults: Counter[str] = Counter()

    def play(self, seconds: float, run: subprocess.Popen[str]) -> None:
        """Plays laps for a time, as long as the run goes on; waits for it to be connected first."""
        until = time.monotonic() + 60.0
        while not self._wire.listening() and time.monotonic() < until:
            time.sleep(0.02)
        begin, lap = time.perf_counter(), 0
        while time.perf_counter() - begin < seconds and run.poll() is None:
            self._lap(lap)
            lap += 1

    def _lap(self, lap: int) -> None:
        schedule = Schedule(self._walk, int(self._rng.integers(2**31)))
        if lap:  # the first one is undisturbed
            name = self._names[int(self._rng.integers(len(self._names)))]
            KINDS[name].fault(schedule)
            self.faults[name] += 1
        first = lap * len(self._walk)
        ratio = self._walk.stream.plate_rate_hz / self._walk.stream.rate_hz
        begin = time.perf_counter()
        for item in schedule.items():
            time.sleep(max(0.0, begin + item.at_s - time.perf_counter()))
            if isinstance(item, Sent):
                ahead = item.plates_ahead + ratio * first
                self.sent += self._wire.send(replace(item, number=item.number + first, plates_ahead=ahead))
            elif hasattr(item, "what"):
                getattr(self._wire, item.what)()


class Memory:
    """A thread that looks at a process's memory every second.

    Attributes:
        warm_bytes: What it held when it became warm.
        bytes: What it held since.
    """

    def __init__(self, process: int, seconds: float) -> None:
        """Args: the process, and how long it will run."""
        self._status = Path(f"/proc/{process}/statm")
        self._warm_s = min(WARM_S, WARM_SHARE * seconds)
        self._ended = threading.Event()
        self.bytes: list[int] = []
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Looks no more."""
        self._ended.set()
        self._thread.join()

    @property
    def growth(self) -> float:
        """Largest difference to what it held when warm, as a share of that; NaN where that is not known."""
        held = np.array(self.bytes, dtype=float)
        return float(np.abs(held / held[0] - 1.0).max()) if len(held) else float("nan")

    def _run(self) -> None:
        begin = time.monotonic()
        while not self._ended.wait(1.0):
            if time.monotonic() - begin >= self._warm_s and self._status.exists():
                self.bytes.append(int(self._status.read_text().split()[1]) * 4096)


class Readers:
    """Reads page and results as long as they are served.

    Attributes:
        messages: How many came.
        lines: What the run said.
    """

    def __init__(self, said: IO[str] | None) -> None:
        """Args: what the run says, with the addresses in it."""
        self.messages, self.lines = 0, list[str]()
        threading.Thread(target=self._watch, args=(said,), daemon=True).start()

    def _watch(self, said: IO[str] | None) -> None:
        for line in said or ():
            self.lines.append(line.rstrip("\n"))
            found = _PAGE.search(line)
            if found:
                threading.Thread(target=self._follow, args=(found[1],), daemon=True).start()

    def _follow(self, url: str) -> None:
        page = url.startswith("http")
        address = f"ws{url.removeprefix('http').rstrip('/')}/frames" if page else url
        try:
            with connect(address, max_size=None) as client:
                for _ in client:
                    self.messages += 1
        except (OSError, WebSocketException):
            return


def _counted(fault: object, walk: Played) -> bool:
    """Whether frames keep their count under a fault."""
    schedule = Schedule(walk, 0)
    assert callable(fault)
    fault(schedule)
    return schedule.counted


def _rows(
    folder: Path, code: int, laps: Laps, memory: Memory, readers: Readers, minutes: float
) -> Iterator[Check]:
    report = json.loads((folder / "live.json").read_text(encoding="utf-8"))
    arrived = int(np.isfinite(read_live_log(folder / LOG_FOLDER).rows["latency_s"]).sum())
    wrong = abs(report["frames_in"] - sum(report[key] for key in ACCOUNTS)) + abs(
        arrived - report["frames_written"]
    )
    name = f"soak, {minutes:g} min, {sum(laps.faults.values())} faults"
    yield Check(f"{name}: exit code", float(code), 0.0, "<=")
    yield Check(
        f"{name}: frames not accounted for", float(wrong + max(0, report["frames_in"] - laps.sent)), 0.0, "<="
    )
    yield Check(f"{name}: memory, largest change since warm", memory.growth, GROWTH, "<=")
    yield information(
        f"{name}: memory when warm", memory.bytes[0] / 2**20 if memory.bytes else float("nan"), "MB"
    )
    yield information(
        f"{name}: memory at the end", memory.bytes[-1] / 2**20 if memory.bytes else float("nan"), "MB"
    )
    yield information(f"{name}: frames sent", float(laps.sent))
    for key in ("frames_in", *ACCOUNTS, "frames_lost_on_the_way", "starts"):
        yield information(f"{name}: {key}", float(report[key]))
    yield information(f"{name}: messages read from page and WebSocket", float(readers.messages))
    if code:
        yield information(f"{name}: it said {readers.lines[-1] if readers.lines else 'nothing'}"[:200], 1.0)
