"""Processor time of a frame of `mbkf reconstruct`, whether its spreads hold, and its memory and pace in long trials.

The command is a process of its own, whose processor time and peak memory the operating system counts, start-up
included. Long trials are a squat of a minute, played forwards and backwards in turn: backwards it obeys Newton's law as
well. What an hour would take is extrapolated from two lengths; ``--minutes M`` runs a trial of M minutes instead.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.speed.consumed import consumed
from benchmarks.speed.products import product_seconds
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import write_subject
from mbkf.trial.synth import synthesise

MINUTE_S, HOUR_MINUTES = 60.0, 60.0
MOTIONS = ("squat", "walk")
FRAME_MS, FRAME_P, CAUSAL_MS = 0.9, 6.0, 0.5
SPREAD_RATIO = 1.002
"""Later readings take no knowledge away. Smoothing and causal filter are linearised elsewhere: 1.0006 in the walk."""

LONG_HZ, LONG_MINUTES = 200.0, 3.0
PEAK_MB, PACE = 600.0, 1.05
PRODUCTS = 400


class Taken(NamedTuple):
    """A command's processor time in s, its peak memory in MB, and the frames of its trial."""

    seconds: float
    peak_mb: float
    frames: int

    @property
    def frame_ms(self) -> float:
        """Processor time of a frame, start-up included."""
        return 1e3 * self.seconds / self.frames


def rows(folder: Path, minutes: float | None = None) -> list[Check]:
    """Time of a frame by motion, smoothed and causal; memory and pace of an hour.

    Args:
        folder: For captures and results.
        minutes: Length of the long trial, which is then the only one but for its first minute; None for all rows.
    """
    if minutes is not None:
        return long_rows(folder, minutes)
    checks: list[Check] = []
    for motion in MOTIONS:
        trial = _written(folder / motion, motion, 100.0, 1.0)
        before = product_s()
        smoothed, causal = (_reconstructed(trial, option) for option in ("--smooth", "--causal"))
        product = min(before, product_s())
        in_products = smoothed.seconds / smoothed.frames / product
        checks += [
            Check(f"reconstruct, 60 s {motion}, a frame", smoothed.frame_ms, FRAME_MS, "<=", "ms"),
            Check("… in products", in_products, FRAME_P, "<=", "P"),
            Check("… causal", causal.frame_ms, CAUSAL_MS, "<=", "ms"),
            information("… causal, in products", causal.seconds / causal.frames / product, "P"),
            Check("… smoothed spread of a dof over causal", _spread_ratio(trial), SPREAD_RATIO, "<=", "×"),
        ]
    return checks + long_rows(folder, LONG_MINUTES)


def long_rows(folder: Path, minutes: float) -> list[Check]:
    """Pace of a trial of so many minutes at 200 Hz beside a minute's, its memory, and what an hour would take.

    Memory of an hour goes on from this trial's as it grows to one of twice the length; an hour is measured.

    Args:
        folder: For captures and results.
        minutes: More than one.

    Raises:
        InvalidInput: It is not more than one minute.
    """
    if minutes <= 1.0:
        raise InvalidInput(
            f"--minutes {minutes:g}: the long trial is compared with its first minute; give more than 1"
        )
    short, long = (_long(folder, length) for length in (1.0, minutes))
    length = f"{minutes:g} minutes at 200 Hz"
    checks = [
        Check(f"{length}: time of a frame over that of a minute", long.frame_ms / short.frame_ms, PACE, "<="),
        information(f"{length}: peak memory", long.peak_mb, "MB"),
    ]
    if minutes >= HOUR_MINUTES:
        return [*checks, Check("an hour at 200 Hz: peak memory", long.peak_mb, PEAK_MB, "<=", "MB")]
    twice = _long(folder, 2.0 * minutes)
    by_frame = (twice.peak_mb - long.peak_mb) / (twice.frames - long.frames)
    hour = twice.peak_mb + max(by_frame, 0.0) * (HOUR_MINUTES * MINUTE_S * LONG_HZ - twice.frames)
    return [
        *checks,
        information(f"{length}, and twice that: memory for a frame more", 1e3 * by_frame, "kB"),
        Check("an hour at 200 Hz, at that rate: peak memory", hour, PEAK_MB, "<=", "MB"),
    ]


def _long(folder: Path, minutes: float) -> Taken:
    """A squat of so many minutes at 200 Hz, smoothed."""
    return _reconstructed(_written(folder / f"{minutes:g} min", "squat", LONG_HZ, minutes), "--smooth")


def repeated(capture: Capture, frames: int) -> Capture:
    """So many frames of a capture, forwards and backwards in turn.

    Args:
        capture: Markers and plates.
        frames: Number of frames wanted.
    """
    markers = capture.markers

    def laid(values: Array, count: int, lap: int) -> Array:
        """``count`` values; a lap is the number of steps from one turn to the next."""
        step = np.arange(count) % (2 * lap)
        return np.asarray(values[np.minimum(step, 2 * lap - step)])

    plates = []
    for plate in capture.plates:
        ratio = plate.rate_hz / markers.rate_hz
        count, lap = round(frames * ratio), round((markers.frames - 1) * ratio)
        force_n, moment_nm = laid(plate.force_n, count, lap), laid(plate.moment_nm, count, lap)
        pressed_m = laid(plate.centre_of_pressure_m, count, lap)
        plates.append(replace(plate, force_n=force_n, moment_nm=moment_nm, centre_of_pressure_m=pressed_m))
    positions = laid(markers.positions_m, frames, markers.frames - 1)
    return Capture("", replace(markers, positions_m=positions), tuple(plates))


def _written(folder: Path, motion: str, rate_hz: float, minutes: float) -> Path:
    """A capture of so many minutes beside its subject."""
    folder.mkdir(parents=True, exist_ok=True)
    person, made = synthesise(motion, seconds=MINUTE_S, rate_hz=rate_hz)
    write_c3d(repeated(made.trial, round(minutes * MINUTE_S * rate_hz)), folder / "trial.c3d")
    write_subject(person, folder / "subject.toml")
    return folder / "trial.c3d"


def _reconstructed(trial: Path, option: str) -> Taken:
    """The command on a capture, with modules that are compiled once and kept, as an installed package has them.

    Raises:
        InvalidInput: It fails.
    """
    out = trial.with_name(option.strip("-"))
    subject = trial.with_name("subject.toml")
    used = consumed("reconstruct", trial, "--subject", subject, option, "--out", out, "--overwrite")
    return Taken(used.seconds, used.peak_mb, _frames(trial))


def _frames(trial: Path) -> int:
    from mbkf.io.capture import read_capture

    return read_capture(trial).markers.frames


def _spread_ratio(trial: Path) -> float:
    """Largest over frames and dofs that the causal run knows; NaN where smoothing lost one."""
    smoothed, causal = (read_reconstruction(trial.with_name(name)).sd_q for name in ("smooth", "causal"))
    known = np.isfinite(causal)
    return float(np.max(smoothed[known] / causal[known]))


def product_s() -> float:
    """P on a single thread: the median of many."""
    return float(np.median([product_seconds() for _ in range(PRODUCTS)]))
