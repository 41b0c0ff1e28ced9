"""The running verdict: its words beside those of the finished run and of `reconstruct`, and its share of a frame.

Captures are played frame by frame through the alignment, the filter and the output of a live run, without clock and
network. Bounds of words are those of :mod:`mbkf.trial.verdict`; no setting was chosen on these trials here.
"""

from __future__ import annotations

import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.loads.trials import Trial
from benchmarks.verdict.faults import KINDS
from benchmarks.verdict.recorded import Base, load
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject, read_subject
from mbkf.io.verdict import PARTS, Verdict
from mbkf.numerics.threads import single_threaded
from mbkf.stream.played import played
from mbkf.stream.receiving.alignment import NO_POINTS, FrameAlignment, ReadyFrame
from mbkf.stream.run.folder import LOG_FOLDER, open_log
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.run.setup import prepare
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.stream.run.verdict import VerdictWatch
from mbkf.stream.source import SourceFrame
from mbkf.trial.live.filter import LiveStep
from mbkf.trial.live.log import read_live_log
from mbkf.trial.live.results import measured_of, results_of
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

SETTINGS = ReconstructSettings(smooth=False, correct_markers=False, other_contacts=False)
MOST_SHARE = 3.0
"""The running verdict's share of a frame's computing time, per cent."""

REPEATS = 5

JUDGEMENT, OWN = "judgement", "synthetic walk"
REAL = ("rajagopal walk", "gait2354", "opencap", "HC032A static", "exact truth", "rehazenter")
PUT_RIGHT = "names within a leg"
"""`reconstruct` puts such names right over the whole recording; a live run reports them, and its verdict is another."""

FAULTS = (
    "mass",
    "clock",
    "gain",
    "plates turned",
    "plates exchanged",
    "another person",
    PUT_RIGHT,
)
SEED = 6
"""Of the walk that faults are put into, and of the faults."""


@dataclass(frozen=True)
class Compared:
    """Verdicts on one trial.

    Attributes:
        label: The trial.
        running: The running verdict after the last frame, with the checks of the finished run.
        live: That of the finished run, from its log.
        offline: That of `reconstruct --causal --keep-markers --feet-only` on the frames that were received.
        left: Largest number of parts that the running verdict had under "do not use" for a time, though the finished
            run has not.
    """

    label: str
    running: Verdict
    live: Verdict
    offline: Verdict
    left: int


def verdict_rows(context: Context) -> Iterator[Check]:
    """Rows of all trials.

    Args:
        context: Folder of the captures; three trials when quick.
    """
    trials = list(_trials(context.require_data()))
    found = [_compared(label, *made()) for label, made in (trials[::6] if context.quick else trials)]
    for one in found:
        others = (("of the finished run", one.live), ("offline", one.offline))
        for name, other in others:
            apart = [part for part in PARTS if one.running.parts[part] != other.parts[part]]
            if apart:
                words = ", ".join(
                    f"{part}: {one.running.parts[part]} / {other.parts[part]}" for part in apart
                )
                yield information(f"{one.label}: running / {name}: {words}", float("nan"))
        if one.left:
            yield information(f"{one.label}: parts that were do not use for a time only", one.left)
    apart_live = sum(one.running.parts != one.live.parts for one in found)
    yield Check(
        f"running verdicts other than the finished run's, of {len(found)} trials", apart_live, 0, "<="
    )
    same = [one for one in found if not one.label.endswith(PUT_RIGHT)]
    apart_offline = sum(one.running.parts != one.offline.parts for one in same)
    name = "running verdicts other than `reconstruct --causal`'s"
    yield Check(f"{name}, of {len(same)} trials", apart_offline, 0, "<=")
    share = 100.0 * _share(*dict(trials)[OWN]())
    yield Check(f"running verdict's share of a frame ({OWN})", share, MOST_SHARE, "<=", "%")


def _share(capture: Capture, subject: Subject) -> float:
    """Time of the running verdict over that of whole frames, each the least of :data:`REPEATS` runs."""
    spent = []
    with single_threaded():
        for _ in range(REPEATS):
            with tempfile.TemporaryDirectory() as scratch:
                spent.append(_run(capture, subject, Path(scratch), [])[1])
    verdict_s, frames_s = np.min(spent, axis=0)
    return float(verdict_s / frames_s)


def _trials(data: Path) -> Iterator[tuple[str, Callable[[], tuple[Capture, Subject]]]]:
    folder = data / JUDGEMENT
    right = folder / "walk7_subject.toml"
    for name in ("walk7_120frames", "pl_rot180"):
        yield name, partial(_read, folder / f"{name}.c3d", right)
    for name in REAL:
        yield name, partial(_loaded, Trial("real", name, data))
    walk = Base("own", "walk", data, str(SEED))
    yield OWN, partial(_faulty, walk, "")
    for kind in FAULTS:
        yield f"{OWN}, {kind}", partial(_faulty, walk, kind)


def _read(path: Path, subject: Path) -> tuple[Capture, Subject]:
    return read_capture(path), read_subject(subject)


def _faulty(base: Base, kind: str) -> tuple[Capture, Subject]:
    recorded, _ = load(base)
    if kind:
        recorded, _ = KINDS[kind](recorded, np.random.default_rng(SEED))
    return recorded.capture, recorded.person()


def _loaded(trial: Trial) -> tuple[Capture, Subject]:
    capture, subject, _ = trial.load()
    return capture, subject


def _compared(label: str, capture: Capture, subject: Subject) -> Compared:
    with single_threaded(), tempfile.TemporaryDirectory() as scratch:
        words: list[Verdict] = []
        watch, _ = _run(capture, subject, Path(scratch), words)
        logged = read_live_log(Path(scratch) / LOG_FOLDER)
        finished = results_of(logged, subject)
        watch._checks.findings = finished.checks  # type: ignore[union-attr]
        watch.end()
        received = Capture(logged.stream.trial, measured_of(logged), logged.stream.plates)
        offline = reconstruct(received, subject, settings=SETTINGS)
    assert watch.judgement is not None and finished.verdict is not None and offline.verdict is not None
    last = finished.verdict.parts
    left = max(
        (sum(one.parts[part] == "do not use" != last[part] for part in one.shown) for one in words), default=0
    )
    return Compared(label, watch.judgement.verdict, finished.verdict, offline.verdict, left)


def _run(
    capture: Capture, subject: Subject, folder: Path, words: list[Verdict]
) -> tuple[VerdictWatch, Array]:
    """Plays a capture into a log; returns the watch, and (2,) the time of its judgements and of all frames, s."""
    source = played(capture)
    setup = prepare(source.stream, subject, SETTINGS, True, _unnoted)
    kept = {"filter": SETTINGS.filter}
    log = open_log(folder, source.stream, setup.rows.dtype, kept, setup.names, subject)
    writer = LogWriter(log, _raised)
    loads = LoadWatch(setup.live, source.stream.rate_hz, _unnoted)
    checks = SimpleNamespace(findings=(), reached=_unasked, restarted=_unasked)
    watch = VerdictWatch(setup, subject, loads, _unnoted, checks, writer.put_doubt)  # type: ignore[arg-type]
    alignment = FrameAlignment(source.stream, setup.columns, _unnoted, subject.mass_kg)
    waiting: deque[ReadyFrame] = deque()
    spent = np.zeros(2)  # the verdict, whole frames

    def answer(steps: Sequence[LiveStep]) -> None:
        for step in steps:
            ready = waiting.popleft()
            assert ready.markers_m is not None
            row, spread = setup.rows.row(step.number, ready.markers_m, step.estimate, step.seconds)
            if spread is not None:
                setup.rows.spread(row, spread)
            load = loads.push(ready, row)
            begin, before = time.perf_counter(), watch.judgement
            watch.push(row, load)
            spent[0] += time.perf_counter() - begin
            if watch.judgement is not None and watch.judgement is not before:
                words.append(watch.judgement.verdict)
            if step.estimate is not None:
                setup.rows.innovation(row, step.estimate)
            writer.put_row(row)

    for frame in source.frames():
        begin = time.perf_counter()
        sent = SourceFrame(frame.number, time.perf_counter(), frame.markers_m, NO_POINTS, frame.plates)
        due, samples = alignment.accept(sent)[:2]
        writer.put_samples(samples)
        for ready in due:
            assert ready.markers_m is not None
            waiting.append(ready)
            answer(setup.filter.push(ready.number, setup.frame(ready, ready.markers_m)))
        spent[1] += time.perf_counter() - begin
    answer(setup.filter.finish())
    watch.end()
    writer.close()
    return watch, spent


def _unnoted(kind: str, what: str, frame: int | None, count: int) -> None:
    """Events of the run are not looked at."""


def _unasked(frames: int) -> None:
    """Checks are those of the finished run."""


def _raised(error: OSError) -> None:
    raise error
