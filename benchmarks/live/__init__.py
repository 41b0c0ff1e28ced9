"""Live: captures replayed through LSL and NatNet on this computer into `mbkf live`: frames lost, latency, equality.

Replay and live run are processes of their own. A latency is the time from a frame's arrival to its result with standard
deviations; frames that wait for the filter's start, which looks a quarter of a second ahead, are not counted in it.
Latencies are those of this machine while nothing else runs on it; how late an idle process wakes up on it meanwhile
stands beside them, for a machine that pauses answers no frame in time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, number
from benchmarks.dynamic.captures import SOURCES
from benchmarks.live.runs import Run, Trial, difference, play
from benchmarks.live.verdicts import verdict_rows
from mbkf.io.capture import read_capture
from mbkf.io.subject import write_subject
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise, write_folder

SECONDS, QUICK_SECONDS = 60.0, 5.0
FAST_HZ, FAST_SECONDS = 250.0, 10.0
RATES_HZ = (200, 300, 400, 500, 600, 800, 1000)
"""Rates at which the synthetic walk is played to find the highest that is sustained."""

SUSTAINED_HZ, SUSTAINED_FRAMES = 1000.0, 10_000
"""Rate that is to be sustained on one core, and for how long."""

CATCHING_UP = 0.2
"""A run whose filter is behind for longer than this share of it does not keep up."""

LATENCY_MS, BEYOND_IDLE_MS = 5.0, 1.5
EQUAL = 1e-9
PROTOCOLS = ("lsl", "natnet")


def run(context: Context) -> list[Check]:
    """All rows; short synthetic captures when quick."""
    checks: list[Check] = []
    seconds = QUICK_SECONDS if context.quick else SECONDS
    walk = synthetic(context.out, seconds, 100.0)
    for trial in (real(context), walk):
        for protocol in PROTOCOLS:
            for view in (False, True):
                checks += rows(trial, protocol, context.out, view)
    unlabelled = replace(
        walk, name=f"{walk.name}, unlabelled", path=walk.path.with_name("raw.c3d"), unlabelled=True
    )
    checks += rows(unlabelled, "lsl", context.out, False)
    checks += verdict_rows(context)
    fast = synthetic(context.out, QUICK_SECONDS if context.quick else FAST_SECONDS, FAST_HZ)
    found = play(fast, "lsl", context.out / "fast")
    checks += [lost(fast.name, found), *latency(fast.name, found, math.inf)]
    if not context.quick:
        checks += sustained(context.out)
        checks.append(
            Check("highest sustained rate, LSL", highest_rate(walk, context.out), SUSTAINED_HZ, ">=", "Hz")
        )
    return checks


def real(context: Context) -> Trial:
    """The Rajagopal walk with its subject."""
    source = SOURCES["rajagopal walk"]
    folder = context.require_data() / source.folder
    assert source.static is not None
    subject = context.out / "rajagopal.toml"
    write_subject(scale(read_capture(folder / source.static), mass_kg=source.mass_kg), subject)
    markers = read_capture(folder / source.trial).markers
    forces = None if source.forces is None else folder / source.forces
    return Trial("rajagopal walk", folder / source.trial, forces, subject, markers.frames / markers.rate_hz)


def synthetic(out: Path, seconds: float, rate_hz: float) -> Trial:
    """A synthetic walk, written once.

    Args:
        out: Folder to write.
        seconds: Duration, s.
        rate_hz: Frame rate.
    """
    folder = out / f"walk-{seconds:g}s-{rate_hz:g}Hz"
    if not (folder / "truth.h5").is_file():
        subject, made = synthesise("walk", seconds=seconds, rate_hz=rate_hz)
        write_folder(subject, made, folder)
    frames = round(seconds * rate_hz) + 1
    name = f"synthetic walk {seconds:g} s, {rate_hz:g} Hz"
    return Trial(name, folder / "trial.c3d", None, folder / "subject.toml", frames / rate_hz)


def rows(trial: Trial, protocol: str, out: Path, view: bool) -> Iterator[Check]:
    """The bounded quantities of one run: lost frames, latency, equality with `reconstruct`.

    Args:
        trial: The capture and its subject.
        protocol: "lsl" or "natnet".
        out: Folder for files.
        view: Whether a live page is open, too.
    """
    found = play(trial, protocol, out / "run", view=view)
    name = f"{trial.name}, {protocol}{', page open' if view else ''}"
    yield lost(name, found)
    yield from latency(name, found, LATENCY_MS if protocol == "lsl" else math.inf)
    if not found.report["frames_lost"]:
        yield Check(f"{name}: difference from reconstruct", difference(found), EQUAL, "<=")


def lost(name: str, found: Run) -> Check:
    """Frames lost."""
    return Check(
        f"{name}: lost of {found.report['frames_in']}", found.report["frames_lost"], 0.0, "<=", "frames"
    )


def latency(name: str, found: Run, bound: float) -> list[Check]:
    """Median and 99th percentile of the latency, and the machine's own pauses.

    Args:
        name: Beginning of the rows' names.
        found: The run.
        bound: Bound of the 99th percentile, ms.
    """
    report, late = found.report, float(np.percentile(found.pauses_ms, 99.0))
    beyond = number(report["latency_ms_p99"]) - late
    return [
        Check(f"{name}: latency, median", number(report["latency_ms_median"]), math.inf, "<=", "ms"),
        Check(f"{name}: latency, 99th percentile", number(report["latency_ms_p99"]), bound, "<=", "ms"),
        Check(f"{name}: an idle process woke late, 99th percentile", late, math.inf, "<=", "ms"),
        Check(
            f"{name}: latency beyond that",
            beyond,
            BEYOND_IDLE_MS if math.isfinite(bound) else math.inf,
            "<=",
            "ms",
        ),
    ]


def sustained(out: Path) -> list[Check]:
    """Ten thousand frames at :data:`SUSTAINED_HZ`: none is lost, and the filter soon keeps up."""
    trial = synthetic(out, SUSTAINED_FRAMES / SUSTAINED_HZ, SUSTAINED_HZ)
    checks: list[Check] = []
    for protocol in PROTOCOLS:
        found, name = play(trial, protocol, out / "sustained"), f"{trial.name}, {protocol}"
        behind = number(found.report["frames_at_start"]) / number(found.report["frames_in"])
        checks += [
            lost(name, found),
            Check(f"{name}: share of frames that waited for the start", behind, CATCHING_UP, "<="),
            *latency(name, found, math.inf),
        ]
    return checks


def highest_rate(trial: Trial, out: Path) -> float:
    """The highest of the rates at which no frame is lost and the start is soon caught up with; 0 where none is."""
    best = 0.0
    for rate_hz in RATES_HZ:
        found = play(trial, "lsl", out / "rate", speed=rate_hz / 100.0)
        behind = found.report["frames_at_start"] > CATCHING_UP * found.report["frames_in"]
        if found.report["frames_lost"] or behind:
            break
        best = float(rate_hz)
    return best
