"""A process that follows senders, one after the other, and states what became of every frame that was sent.

    python -m benchmarks.misuse.senders.child FOLDER PROTOCOL KIND:SEED …

Each outcome is a line of JSON.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from benchmarks.misuse.senders.judging import (
    SentFrame,
    first_live_s,
    frames_in,
    unaccounted,
    wrong_loads,
    wrong_numbers,
)
from benchmarks.misuse.senders.kinds import KINDS, Kind, scheduled
from benchmarks.misuse.senders.wires import ReorderedLslWire, ReorderedNatNetWire
from benchmarks.robustness.stream_child import ACCOUNTS, PATIENCE_S, Sender
from benchmarks.robustness.stream_kinds import LSL
from benchmarks.robustness.stream_schedule import Sent
from mbkf.io.capture import read_capture
from mbkf.io.subject import read_subject
from mbkf.stream.played import Played, played
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.stream.run.session import LiveSession
from mbkf.trial.live.log import Logged, read_live_log
from mbkf.trial.preparation.settings import ReconstructSettings


class Recorded:
    """A wire that notes when each frame was sent."""

    def __init__(self, wire: ReorderedLslWire | ReorderedNatNetWire) -> None:
        self._wire = wire
        self.sent: list[tuple[Sent, float]] = []

    def send(self, one: Sent) -> bool:
        """Sends a frame."""
        now, through = time.perf_counter(), self._wire.send(one)
        if through:
            self.sent.append((one, now))
        return through

    def __getattr__(self, name: str) -> object:
        return getattr(self._wire, name)


class Answers:
    """A listener that notes when each frame was answered."""

    def __init__(self) -> None:
        self.answers: list[tuple[float, np.ndarray]] = []

    def take(self, frame: LiveFrame) -> None:
        """Notes an answer."""
        self.answers.append((time.perf_counter(), frame.measured_m))

    def close(self) -> None:
        """The run has ended."""


def outcome(name: str, seed: int, walk: Played, folder: Path) -> dict[str, object]:
    """Plays a sender to a live run and accounts for each frame that it sent.

    Args:
        name: Its kind.
        seed: Which of its kind.
        walk: What is played.
        folder: Holds the subject; the run's own folder is made in it.
    """
    kind, schedule = KINDS[name], scheduled(name, walk, seed)
    own = f"{kind.protocol}-{os.getpid()}-{seed}"
    wire = (
        ReorderedLslWire(walk, f"mbkf-{own}", schedule.counted)
        if kind.protocol == LSL
        else ReorderedNatNetWire(walk)
    )
    recorded, answers = Recorded(wire), Answers()
    go, stop = threading.Event(), threading.Event()
    sender = Sender(recorded, schedule, go, stop)  # type: ignore[arg-type]
    session = LiveSession(
        wire.source(),
        read_subject(folder / "subject.toml"),
        ReconstructSettings(correct_markers=False),
        folder / own,
        kind.protocol,
    )
    try:
        if kind.protocol != LSL:  # the rate follows from the first frames
            go.set()
        sender.start()
        session.connect(threading.Event(), PATIENCE_S)
        go.set()
        begin_s = time.perf_counter()
        found = session.run(stop, [answers], keep_log=True)
        sender.join()
        died = [str(one) for one in (found.failure, found.problem, sender.error) if one]
        rate_hz = walk.stream.rate_hz
        sent = [
            SentFrame(one.frame, round(one.at_s * rate_hz) if kind.by_time else one.frame, at_s)
            for one, at_s in recorded.sent
        ]
        logged = read_live_log(folder / own / LOG_FOLDER)
        begin_s = max(begin_s, sent[0].at_s)
        return {
            "died": died,
            **_judged(kind, found.report, logged, walk, sent, schedule.whole, answers, begin_s),
        }
    finally:
        wire.close()


def _judged(
    kind: Kind,
    report: dict[str, object],
    logged: Logged,
    walk: Played,
    sent: list[SentFrame],
    whole: bool,
    answers: Answers,
    begin_s: float,
) -> dict[str, object]:
    """What the log and live.json of a run say of the frames that were sent."""
    names = walk.stream.marker_names
    markers = walk.markers_m[:, [names.index(name) for name in logged.names]]
    arrived = np.isfinite(logged.rows["latency_s"])
    frames = frames_in(logged.rows["measured_m"][arrived], markers)
    counts = {key: int(str(report[key])) for key in (*ACCOUNTS, "frames_in", "frames_lost_on_the_way")}
    books = abs(counts["frames_in"] - sum(counts[key] for key in ACCOUNTS))
    events = report["events"]
    assert isinstance(events, list)
    seen = [at_s for at_s, _ in answers.answers]
    held = frames_in(np.array([measured for _, measured in answers.answers]), markers)
    loads = np.stack([np.hstack([one.force_n, one.moment_nm]) for one in logged.stream.plates], 1)
    first = round(
        (logged.stream.plates[0].start_time_s - walk.stream.plates[0].start_time_s)
        * walk.stream.plate_rate_hz
    )
    wrong = wrong_loads(loads, walk.wrench[first:]) if kind.plates else 0
    return {
        "unaccounted": books + unaccounted(counts, frames, sent, whole),
        "wrong numbers": wrong_numbers(logged.rows["number"][arrived], frames, sent, kind.apart),
        "wrong loads": wrong,
        "unnamed": int((frames == -1).sum()),
        "first live answer": first_live_s(list(zip(seen, held.tolist(), strict=True)), sent, begin_s),
        "unreported": int(bool(kind.event) and kind.event not in {event["kind"] for event in events}),
        "counts": counts,
        "kinds": {event["kind"]: event["count"] for event in events},
    }


def main(words: Iterable[str]) -> None:
    """Follows senders that words name, a line before and after each."""
    warnings.simplefilter("ignore")
    place, _, *asked = words
    folder = Path(place)
    walk = played(read_capture(folder / "trial.c3d"))
    for word in asked:
        name, seed = word.rsplit(":", 1)
        print(json.dumps({"begin": word}), flush=True)
        try:
            found = outcome(name, int(seed), walk, folder)
        except Exception as error:
            found = {"died": [f"the run: {error!r}"]}
        print(json.dumps({"end": word, **found}), flush=True)
    sys.stdout.flush()
    os._exit(0)  # threads of libraries may linger


if __name__ == "__main__":
    main(sys.argv[1:])
