"""A process that follows disturbed streams, one after the other, and tells what became of each.

    python -m benchmarks.robustness.stream_child FOLDER PROTOCOL FAULT:SEED …

Each outcome is a line of JSON.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.robustness.stream_kinds import KINDS, LSL, Fault
from benchmarks.robustness.stream_schedule import Packet, Schedule, Sent
from benchmarks.robustness.stream_wire import LslWire, NatNetWire, Wire
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject
from mbkf.stream.played import Played, played
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.stream.run.session import LiveOutcome, LiveSession
from mbkf.trial.live.log import read_live_log
from mbkf.trial.preparation.settings import ReconstructSettings

PATIENCE_S, LINGER_S = 20.0, 0.5
"""A stream is looked for so long; after its last frame it stays so long."""

END_FRAMES = 10
"""Of so many frames at the end one has to be tracked."""

MakeWire = Callable[[Played], Wire]

ACCOUNTS = ("frames_written", "frames_not_written", "frames_unanswered", "frames_late", "frames_overwritten")


class Sender(threading.Thread):
    """Sends a schedule once its receiver is connected, and then ends the run.

    Attributes:
        sent: Frames sent through an open stream.
        error: What ended it early.
    """

    def __init__(self, wire: Wire, schedule: Schedule, go: threading.Event, stop: threading.Event) -> None:
        """A thread that is not started yet.

        Args:
            wire: The player.
            schedule: What to send.
            go: Set when to begin.
            stop: What is set at the end.
        """
        super().__init__(name="sender", daemon=True)
        self._wire, self._schedule, self._go, self._stop_run = wire, schedule, go, stop
        self.sent = 0
        self.error: Exception | None = None

    def run(self) -> None:
        """Sends everything, each item when its time has come."""
        try:
            until = time.monotonic() + PATIENCE_S
            while time.monotonic() < until and not (self._go.is_set() and self._wire.listening()):
                time.sleep(0.005)
            begin = time.perf_counter()
            for item in self._schedule.items():
                time.sleep(max(0.0, begin + item.at_s - time.perf_counter()))
                if isinstance(item, Sent):
                    self.sent += self._wire.send(item)
                elif isinstance(item, Packet):
                    self._wire.packet(item.data, item.stranger)
                elif hasattr(self._wire, item.what):
                    getattr(self._wire, item.what)()
            time.sleep(LINGER_S)
        except Exception as error:
            self.error = error
        finally:
            self._stop_run.set()


def wire_of(protocol: str, walk: Played, name: str, counted: bool) -> Wire:
    """The player of a protocol.

    Args:
        protocol: "lsl" or "natnet".
        walk: The capture.
        name: Of the stream, where the protocol has names.
        counted: Whether frames carry a count.
    """
    return LslWire(walk, name, counted) if protocol == LSL else NatNetWire(walk)


def outcome(
    protocol: str, fault: Fault, seed: int, walk: Played, folder: Path, make: MakeWire | None = None
) -> dict[str, object]:
    """Runs a live reconstruction on a stream with a fault, and returns its end.

    Args:
        protocol: Of the stream.
        fault: Alters what is sent.
        seed: Which of its kind.
        walk: What is played.
        folder: Holds the subject; the run's own folder is made in it.
        make: Makes the player of a capture; None for the one of LSL or NatNet.
    """
    died: list[str] = []
    threading.excepthook = lambda args: died.append(f"{args.thread and args.thread.name}: {args.exc_value!r}")
    schedule = Schedule(walk, seed)
    fault(schedule)
    own = f"{protocol}-{os.getpid()}-{seed}"
    wire = wire_of(protocol, walk, f"mbkf-{own}", schedule.counted) if make is None else make(walk)
    go, stop = threading.Event(), threading.Event()
    sender = Sender(wire, schedule, go, stop)
    settings = ReconstructSettings(correct_markers=False)
    session = LiveSession(
        wire.source(), read_subject(folder / "subject.toml"), settings, folder / own, protocol
    )
    try:
        if protocol != LSL:  # the rate follows from the first frames
            go.set()
        sender.start()
        session.connect(threading.Event(), PATIENCE_S)
        go.set()
        found = session.run(stop, keep_log=True)
        sender.join()
        return _told(found, sender, schedule, died, folder / own)
    finally:
        wire.close()


def _told(
    found: LiveOutcome, sender: Sender, schedule: Schedule, died: list[str], folder: Path
) -> dict[str, object]:
    """What a run and its log say."""
    report: dict[str, object] = found.report
    counts = {key: int(str(report[key])) for key in (*ACCOUNTS, "frames_in")}
    logged = int(np.isfinite(read_live_log(folder / LOG_FOLDER).rows["latency_s"]).sum())
    wrong = abs(counts["frames_in"] - sum(counts[key] for key in ACCOUNTS)) + abs(
        logged - counts["frames_written"]
    )
    unseen = sender.sent - counts["frames_in"]
    tracked = found.summary is not None and bool(read_reconstruction(folder).tracked[-END_FRAMES:].any())
    events = report["events"]
    assert isinstance(events, list)
    return {
        "died": [
            *died,
            *([found.failure] if found.failure else []),
            *([repr(sender.error)] if sender.error else []),
        ],
        "unaccounted": wrong + (abs(unseen) if schedule.whole else max(0, -unseen)),
        "sent": sender.sent,
        "counts": counts,
        "problem": found.problem,
        "tracked": tracked,
        "kinds": {event["kind"]: event["count"] for event in events},
        "listed": len(events),
    }


def main(words: Iterable[str], faults: Mapping[str, Fault], make: MakeWire | None = None) -> None:
    """Follows what the words name, a line before and after each.

    Args:
        words: Folder, protocol, and ``FAULT:SEED`` of each run.
        faults: Faults by name.
        make: Makes the player, as for :func:`outcome`.
    """
    warnings.simplefilter("ignore")
    place, protocol, *asked = words
    folder = Path(place)
    whole = played(read_capture(folder / "trial.c3d"))
    walk = replace(whole, wrench=whole.wrench)
    for word in asked:
        fault, seed = word.rsplit(":", 1)
        print(json.dumps({"begin": word}), flush=True)
        try:
            told = outcome(protocol, faults[fault], int(seed), walk, folder, make)
        except Exception as error:
            told = {"died": [f"the run: {error!r}"], "unaccounted": 0}
        print(json.dumps({"end": word, **told}), flush=True)
    sys.stdout.flush()
    os._exit(0)  # threads of libraries may linger


if __name__ == "__main__":
    main(sys.argv[1:], {name: kind.fault for name, kind in KINDS.items()})
