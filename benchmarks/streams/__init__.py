"""Streams: captures played through simulators of laboratories' servers into `mbkf live`.

Rows: frames lost, equality with `reconstruct --causal`, the recording, latency beyond that of an idle process, more
markers, points without names, disturbed streams, results out, and the simulator read by a client that others wrote.
Replay and live run are processes of their own. Latencies are those of this machine and of whatever else it does; bounds
hold on a quiet one: beside them stands how much longer a fixed piece of work takes after a pause than right away.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information, number
from benchmarks.live import lost
from benchmarks.live.runs import COMPARED, Run, difference, largest_difference, play
from benchmarks.parts import part_rows
from benchmarks.robustness import stream_faults
from benchmarks.streams.clients import ROWS, client_rows
from benchmarks.streams.faults import FAULTS
from benchmarks.streams.results_out import out_rows
from benchmarks.streams.scenes import MANY, belt_walk
from benchmarks.streams.xsens import xsens_rows
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import SUBJECT_FILE, read_live_log
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.synth import synthesise, write_folder

SECONDS, QUICK_SECONDS = 20.0, 5.0
RATES_HZ = (100.0, 300.0)
EQUAL, SINGLE = 0.0, 1e-4
"""Bounds of differences: of the same frames, and of frames in a file's single precision."""

CAUGHT_UP_S, BEHIND_S = 1.0, 0.05
"""Within a second of its first frame, a run answers no later than this after a frame arrives."""

MEDIAN_MS, P99_MS = 1.0, 3.0
"""Bounds of latency beyond that of an idle process."""


def run(context: Context) -> list[Check]:
    """Rows of all protocols and of results out, or of those of ``--only``."""
    protocols = {name: partial(stream_rows, protocol=name) for name in FAULTS}
    return part_rows(context, {**protocols, "out": out_rows, "xsens": xsens_rows})


def stream_rows(context: Context, protocol: str) -> Iterator[Check]:
    """Rows of a protocol."""
    seconds = QUICK_SECONDS if context.quick else SECONDS
    scene = partial(belt_walk, context.out, seconds)
    for trial in (
        *(scene(rate_hz) for rate_hz in RATES_HZ),
        scene(RATES_HZ[0], markers=MANY),
        scene(RATES_HZ[0], named=False),
    ):
        folder = context.out / trial.name.replace(" ", "-").replace(",", "")
        file = folder.with_suffix(".c3d")
        found = play(trial, protocol, folder, more=("--record", file, "--overwrite"))
        yield lost(trial.name, found)
        yield Check(f"{trial.name}: difference from reconstruct --causal", difference(found), EQUAL, "<=")
        if not trial.unlabelled:
            apart = recorded_difference(found, file)
            yield Check(f"{trial.name}: difference from the recorded C3D file", apart, SINGLE, "<=")
        log = read_live_log(found.folder / LOG_FOLDER)
        caught_up = caught_up_s(log.rows["number"] / log.stream.rate_hz, log.rows["latency_s"])
        yield Check(
            f"{trial.name}: from the first frame until 50 ms behind", caught_up, CAUGHT_UP_S, "<=", "s"
        )
        yield from latency(trial.name, found)
    yield from fault_rows(context, protocol)
    if protocol in ROWS:
        yield from client_rows(context, protocol)


def recorded_difference(found: Run, file: Path) -> float:
    """Largest difference of a run from the causal results of its recording, from 2 s on, but for the last frame.

    The file's plates begin with its first frame, half of whose samples the run has from before, and pelvis angles and
    moments depend on the direction of all frames; both are left out. Relative to the value where that is larger than
    one; NaN where different samples are known. The recording may go on after the run.
    """
    subject = read_subject(found.folder / LOG_FOLDER / SUBJECT_FILE)
    settings = ReconstructSettings(smooth=False, correct_markers=False)
    capture = read_capture(file, tare=False)
    again, run = reconstruct(capture, subject, settings=settings), read_reconstruction(found.folder)
    part = slice(round(2.0 * capture.markers.rate_hz), min(run.frames, again.frames) - 1)
    names = [name for name in COMPARED if name not in ("angles", "moments")]
    return largest_difference(run, again, names, part)


def caught_up_s(times_s: Array, latency_s: Array) -> float:
    """Time from the first frame's arrival until frames are answered within :data:`BEHIND_S`.

    Args:
        times_s: (T,) times of the frames.
        latency_s: (T,) from each arrival to its answer; NaN for lost frames.
    """
    soon = np.flatnonzero(latency_s <= BEHIND_S)
    return float((times_s + latency_s)[soon[0]] - times_s[0]) if len(soon) else np.inf


def latency(name: str, found: Run) -> Iterator[Check]:
    """Median and 99th percentile of the latency beyond that of an idle process, which stands beside it."""
    for word, percent, bound in (("median", 50.0, MEDIAN_MS), ("99th percentile", 99.0, P99_MS)):
        idle = float(np.percentile(found.pauses_ms, percent))
        whole = number(found.report["latency_ms_median" if percent == 50.0 else "latency_ms_p99"])
        yield Check(f"{name}: latency beyond an idle process, {word}", whole - idle, bound, "<=", "ms")
        yield information(f"{name}: an idle process woke late, {word}, ms", idle)
    if len(found.work_ms):
        after, again = np.median(found.work_ms, axis=0)
        yield information(f"{name}: work after a pause, times that right away", float(after / again))


def fault_rows(context: Context, protocol: str) -> Iterator[Check]:
    """Each fault three times, once when quick."""
    folder = context.out / "faults"
    subject, walk = synthesise("walk", seconds=stream_faults.SECONDS, rate_hz=100.0)
    write_folder(subject, walk, folder)
    times, first = (1 if context.quick else stream_faults.TIMES), time.time_ns() % 2**31
    words = [f"{name}:{first + 10 * k + j}" for k, name in enumerate(FAULTS[protocol]) for j in range(times)]
    jobs = [
        (protocol, words[at : at + stream_faults.CHUNK]) for at in range(0, len(words), stream_faults.CHUNK)
    ]
    follow = partial(stream_faults.follow, folder=folder, module="benchmarks.streams.child")
    with ThreadPoolExecutor(stream_faults.WORKERS) as pool:
        found = {word: told for some in pool.map(follow, jobs) for word, told in some.items()}
    yield from stream_faults.rows(found, protocol)
