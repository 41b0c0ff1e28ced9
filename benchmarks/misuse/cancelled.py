"""Runs of ten minutes of capture, cancelled at random instants: ended within two seconds, nothing half-written left.

A quarter of them each: a run of the page by its Cancel, the page's command by SIGTERM, ``mbkf batch`` by SIGTERM and
``mbkf reconstruct`` by Ctrl-C. Instants are spread over the time that a run took, those of the shorter steps at its
begin and end included.
"""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from mbkf.app.run_states import RUNNING
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.conventions import Array
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.trial.synth import synthesise, write_folder

CANCELS, QUICK_CANCELS = 40, 4
MINUTES, QUICK_MINUTES = 10, 1
PIECE_S = 60.0
WITHIN_S = 2.0
PATIENCE_S = 1200.0
EDGE_S = 8.0
"""A third of the instants lies in the first seconds, in which libraries, captures and the person are read."""

HEEDING = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from mbkf.cli.main import main
sys.exit(main())
"""
"""The command; a background job of a shell is born ignoring SIGINT, and so are its children."""

Way = Callable[[Path, Path, float], float]
"""Begins a run of a study, with results in a folder; cancels it after a time, s; returns how long it then took, s."""


def rows(context: Context) -> list[Check]:
    """Cancelled runs that ended in time and left nothing."""
    count = QUICK_CANCELS if context.quick else CANCELS
    lab = long_study(context.out / "lab", QUICK_MINUTES if context.quick else MINUTES)
    begun = time.monotonic()
    batch = [*_mbkf("batch", lab, "--workers", "1"), "--out", str(context.out / "whole")]
    subprocess.run(batch, check=True, capture_output=True)
    whole_s = time.monotonic() - begun
    chosen, held, longest, faults = random.Random(context.seed), 0, 0.0, []
    for number in range(count):
        way = WAYS[number % len(WAYS)]
        at_s = chosen.uniform(0.2, EDGE_S if number % 3 == 0 else whole_s)
        out = lab / "results" if way in (_cancel, _end_page) else context.out / "out"
        shutil.rmtree(out, ignore_errors=True)
        took_s = way(lab, out, at_s)
        left = half_written(out)
        longest = max(longest, took_s)
        held += took_s <= WITHIN_S and not left
        if took_s > WITHIN_S or left:
            faults.append(
                f"{way.__name__[1:]} after {at_s:.1f} s of {whole_s:.0f}: {took_s:.1f} s; left {left}"
            )
    (context.out / "faults.txt").write_text("\n".join(faults), encoding="utf-8")
    return [
        Check(f"{count} runs cancelled: ended within {WITHIN_S:g} s, no half folder", held, count, ">="),
        Check("longest time from the cancel to the end", longest, np.inf, "<=", "s"),
    ]


def long_study(folder: Path, minutes: int) -> Path:
    """A study of one person with one long trial on a treadmill: a minute again and again.

    Args:
        folder: The study's folder.
        minutes: Length of the trial.
    """
    shutil.rmtree(folder, ignore_errors=True)
    own = folder / "P1"
    own.mkdir(parents=True)
    made = folder.with_name("minute")
    write_folder(*synthesise("belt_walk", seconds=PIECE_S), made)
    shutil.copy(made / "static.c3d", own)
    shutil.copy(made / "subject.toml", folder.with_name("subject.toml"))
    capture = read_capture(made / "trial.c3d")
    markers = _repeated(capture.markers.positions_m, minutes)
    plates = tuple(
        replace(
            plate,
            force_n=_repeated(plate.force_n, minutes),
            moment_nm=_repeated(plate.moment_nm, minutes),
            centre_of_pressure_m=_repeated(plate.centre_of_pressure_m, minutes),
        )
        for plate in capture.plates
    )
    long = replace(capture, markers=replace(capture.markers, positions_m=markers), plates=plates)
    write_c3d(long, own / "walk.c3d")
    return folder


def _repeated(samples: Array, times: int) -> Array:
    return np.concatenate([samples] * times)


def _cancel(lab: Path, _out: Path, at_s: float) -> float:
    """The page's Cancel; the time until all processes of the run have gone."""
    runs = Runs(Workspace(lab), 1)
    runs.start("P1")
    runs.wait(lambda: getattr(runs.state("P1"), "state", "") == RUNNING, PATIENCE_S)
    time.sleep(at_s)
    begin = time.monotonic()
    runs.cancel("P1")
    while _children() and time.monotonic() - begin < PATIENCE_S:
        time.sleep(0.01)
    took_s = time.monotonic() - begin
    runs.close()
    return took_s


def _end_page(lab: Path, _out: Path, at_s: float) -> float:
    """SIGTERM to the page's command while a run goes on."""
    runs = lab / "results" / "runs.json"
    runs.parent.mkdir(parents=True, exist_ok=True)
    runs.write_text('{"P1": {"state": "running"}}', encoding="utf-8")  # the next server continues it
    return _ended(_mbkf("app", lab, "--no-browser"), at_s, signal.SIGTERM)


def _end_batch(lab: Path, out: Path, at_s: float) -> float:
    """SIGTERM to ``mbkf batch``."""
    return _ended([*_mbkf("batch", lab, "--workers", "1"), "--out", str(out)], at_s, signal.SIGTERM)


def _interrupt(lab: Path, out: Path, at_s: float) -> float:
    """Ctrl-C to ``mbkf reconstruct``."""
    subject = str(lab.with_name("subject.toml"))
    words = [*_mbkf("reconstruct", lab / "P1" / "walk.c3d", "--subject", subject), "--out", str(out / "walk")]
    return _ended(words, at_s, signal.SIGINT)


WAYS: tuple[Way, ...] = (_cancel, _end_page, _end_batch, _interrupt)


def half_written(out: Path) -> list[str]:
    """Unfinished files and folders below a folder of results, and results that cannot be read."""
    left = [path.name for path in out.rglob(".*")]
    for walk in out.rglob("walk"):
        try:
            read_reconstruction(walk)
        except Exception as error:
            left.append(f"{walk.name}: {error}")
    return left


def _mbkf(command: str, *words: str | Path) -> list[str]:
    return [sys.executable, "-c", HEEDING, command, *map(str, words)]


def _ended(words: list[str], at_s: float, number: int) -> float:
    """The time from a signal to the end of a command and all its processes, s."""
    with subprocess.Popen(
        words,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(at_s)
        begin = time.monotonic()
        process.send_signal(number)
        process.wait(PATIENCE_S)
        while _group_lives(process.pid) and time.monotonic() - begin < PATIENCE_S:
            time.sleep(0.01)
        return time.monotonic() - begin


def _group_lives(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def _children() -> bool:
    """True while this process has children."""
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return False
    return True
