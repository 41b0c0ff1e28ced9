"""Streams: captures played through simulators of laboratories' servers into `mbkf live`.

Rows: frames lost, equality with `reconstruct --causal`, latency beyond that of an idle process, disturbed streams, and
the simulator read by a client that others wrote. Replay and live run are processes of their own. Latencies are those of
this machine and of whatever else it does; bounds hold on a quiet one.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from benchmarks.checks import Check, Context, information, number
from benchmarks.live import lost, synthetic
from benchmarks.live.runs import Run, difference, play
from benchmarks.parts import part_rows
from benchmarks.robustness import stream_faults
from benchmarks.streams.clients import client_rows
from benchmarks.streams.faults import FAULTS
from mbkf.trial.synth import synthesise, write_folder

SECONDS, QUICK_SECONDS = 20.0, 5.0
RATES_HZ = (100.0, 300.0)
EQUAL = 0.0
MEDIAN_MS, P99_MS = 1.0, 3.0
"""Bounds of latency beyond that of an idle process."""


def run(context: Context) -> list[Check]:
    """Rows of all protocols, or of those of ``--only``."""
    return part_rows(context, {name: partial(stream_rows, protocol=name) for name in FAULTS})


def stream_rows(context: Context, protocol: str) -> Iterator[Check]:
    """Rows of a protocol."""
    seconds = QUICK_SECONDS if context.quick else SECONDS
    for rate_hz in RATES_HZ:
        trial = synthetic(context.out, seconds, rate_hz)
        found = play(trial, protocol, context.out / f"run-{rate_hz:g}")
        yield lost(trial.name, found)
        yield Check(f"{trial.name}: difference from reconstruct --causal", difference(found), EQUAL, "<=")
        yield from latency(trial.name, found)
    yield from fault_rows(context, protocol)
    if protocol == "qualisys":
        yield from client_rows(context)


def latency(name: str, found: Run) -> Iterator[Check]:
    """Median and 99th percentile of the latency beyond that of an idle process, which stands beside it."""
    for word, percent, bound in (("median", 50.0, MEDIAN_MS), ("99th percentile", 99.0, P99_MS)):
        idle = float(np.percentile(found.pauses_ms, percent))
        whole = number(found.report["latency_ms_median" if percent == 50.0 else "latency_ms_p99"])
        yield Check(f"{name}: latency beyond an idle process, {word}", whole - idle, bound, "<=", "ms")
        yield information(f"{name}: an idle process woke late, {word}, ms", idle)


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
