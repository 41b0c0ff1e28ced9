"""The trials of this benchmark as live streams: forces that are stated while they act, and clean streams accused.

A capture is played frame by frame through the alignment, the filter and the judgement of a live run, without its clock,
network and files. Limits of :mod:`mbkf.trial.loads.running` were chosen on all of these trials: the rows keep them.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.checks import Check, information
from benchmarks.loads.judged import SPOILT_SHARE
from benchmarks.loads.trials import Trial
from mbkf.conventions import GRAVITY_M_S2, BoolArray
from mbkf.io.contacts import bearing
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.runs import runs
from mbkf.numerics.threads import single_threaded
from mbkf.stream.played import Played, played
from mbkf.stream.receiving.alignment import NO_POINTS, FrameAlignment, ReadyFrame
from mbkf.stream.run.setup import LiveSetup, prepare
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.stream.source import SourceFrame
from mbkf.trial.live.filter import LiveStep
from mbkf.trial.preparation.settings import ReconstructSettings

STATED_AFTER_S = 0.5
"""From so long after a load begins, its frames may not count."""

MOST_FRAMES = 5
"""A clean stream may be accused in so few frames."""


@dataclass(frozen=True)
class Streamed:
    """Judgement of a stream.

    Attributes:
        label: The trial.
        frames, stated: Number of frames, and of those in which a force is stated.
        opened: Number of frames in which a contact of another part than the feet is open.
        spoilt: Frames under a load above :data:`~benchmarks.loads.judged.SPOILT_SHARE` that count,
            :data:`STATED_AFTER_S` after it begins; NaN where the load is not known.
        longest_s: Longest time from a load's beginning until it is stated, and from its end until it is not; NaN
            likewise.
    """

    label: str
    frames: int
    stated: int
    opened: int
    spoilt: float
    longest_s: tuple[float, float]


def streamed(trial: Trial) -> Streamed:
    """Plays and judges a trial.

    Args:
        trial: The trial.
    """
    with single_threaded():
        capture, subject, unread = trial.load()
        acts, bears = judged_frames(capture, subject)
    counted = len(acts), int(acts.sum()), int(bears.sum())
    if unread is None:
        return Streamed(trial.label, *counted, float("nan"), (float("nan"), float("nan")))
    rate_hz, frames = capture.markers.rate_hz, min(len(unread), len(acts))
    loaded = np.linalg.norm(unread[:frames], axis=1) > SPOILT_SHARE * subject.mass_kg * GRAVITY_M_S2
    spoilt, begins, ends = against_truth(acts[:frames], loaded & ~bears[:frames], rate_hz)
    return Streamed(trial.label, *counted, spoilt, (begins, ends))


def judged_frames(capture: Capture, subject: Subject) -> tuple[BoolArray, BoolArray]:
    """(T,) frames of a stream in which an unexplained force is stated, and (T,) those with a contact besides the feet.

    Args:
        capture: The capture that is played.
        subject: The person.
    """
    source = played(capture)
    setup = prepare(source.stream, subject, ReconstructSettings(), True, _unnoted)
    watch = LoadWatch(setup.live, source.stream.rate_hz, _unnoted)
    found = [
        (watch.push(ready, row).acts, bearing(row["support"]).any())
        for ready, row in _answered(source, setup, subject)
    ]
    acts, bears = np.array(found, dtype=bool).reshape(-1, 2).T
    return acts, bears


def _answered(source: Played, setup: LiveSetup, subject: Subject) -> Iterator[tuple[ReadyFrame, NDArray]]:
    """The frames of a stream in order, each with its row of the log."""
    alignment = FrameAlignment(source.stream, setup.columns, _unnoted, subject.mass_kg)
    waiting: deque[ReadyFrame] = deque()

    def rows(steps: Sequence[LiveStep]) -> Iterator[tuple[ReadyFrame, NDArray]]:
        for step in steps:
            ready = waiting.popleft()
            assert ready.markers_m is not None
            yield ready, setup.rows.row(step.number, ready.markers_m, step.estimate, step.seconds)[0]

    for frame in source.frames():
        sent = SourceFrame(frame.number, time.perf_counter(), frame.markers_m, NO_POINTS, frame.plates)
        for ready in alignment.accept(sent)[0]:
            assert ready.markers_m is not None
            waiting.append(ready)
            yield from rows(setup.filter.push(ready.number, setup.frame(ready, ready.markers_m)))
    yield from rows(setup.filter.finish())


def _unnoted(kind: str, what: str, frame: int | None, count: int) -> None:
    """Events of the run are not looked at."""


def against_truth(acts: BoolArray, loaded: BoolArray, rate_hz: float) -> tuple[float, float, float]:
    """Frames under a load that count from :data:`STATED_AFTER_S` on; longest times until it is stated, and after it.

    Args:
        acts: (T,) frames in which a force is stated.
        loaded: (T,) frames under a load.
        rate_hz: Frame rate.
    """
    due, begins, after = loaded.copy(), [0.0], [0.0]
    for first, end in runs(loaded):
        due[first : first + round(STATED_AFTER_S * rate_hz)] = False
        stated, released = np.flatnonzero(acts[first:end]), np.flatnonzero(~acts[end:])
        if len(stated):
            begins.append(stated[0] / rate_hz)
        if len(released):
            after.append(released[0] / rate_hz)
    return float((due & ~acts).sum()), max(begins), max(after)


def live_rows(clean: Sequence[Streamed], violating: Sequence[Streamed]) -> Iterator[Check]:
    """Rows of streams: accused clean ones, and frames under a load that count.

    Args:
        clean: Streams without a load or fault.
        violating: Streams with one.
    """
    for one in clean:
        if one.stated:
            yield information(
                f"live, clean, {one.label}: frames of {one.frames} in which a force is stated", one.stated
            )
    accused = sum(one.stated > MOST_FRAMES for one in clean)
    yield Check(
        f"live: clean streams accused for more than {MOST_FRAMES} frames, of {len(clean)}", accused, 0, "<="
    )
    for one in clean:
        if one.opened:
            yield information(f"live, clean, {one.label}: frames of {one.frames} with a contact", one.opened)
    opened = sum(one.opened > 0 for one in clean)
    yield Check(f"live: clean streams in which a contact opens, of {len(clean)}", opened, 0, "<=")
    stated = sum(one.stated > 0 for one in violating)
    yield Check(
        f"live: violators in which a force is stated, of {len(violating)}", stated, len(violating), ">="
    )
    known = [one for one in violating if np.isfinite(one.spoilt)]
    yield Check(
        f"live: frames that count under a load above 8 % of body weight, {STATED_AFTER_S} s after it begins, "
        f"{len(known)} streams",
        sum(one.spoilt for one in known),
        0.0,
        "<=",
    )
    for k, words in enumerate(("a load's beginning until it is stated", "its end until it is not")):
        longest = max((one.longest_s[k] for one in known), default=float("nan"))
        yield information(f"live: longest time from {words}", longest, "s")
