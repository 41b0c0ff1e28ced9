"""Running and belts with every plate withheld, and whether stated spreads are what reactions without plates err by.

The runs are Rajagopal's on a treadmill and BMC's overground; gait2354 walks on a treadmill, Rehazenter's person slowly.
The settings were set on HC032A, the rajagopal walk and the treadmill run; all others were only looked at. Spreads are
judged by phase and over all captures of a phase, since one capture has ten to thirty frames of double support.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information, within
from benchmarks.contact.shared import BEARS_N, PASSES, REAL_WALKS, RealWalk, read_walk, rms
from benchmarks.contact.withheld import MEASURED_UNTIL_S, compared, without_plates
from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.sensors.contact.records import Contact
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

RUNS = {
    "treadmill run": RealWalk(
        "rajagopal_walk_run/motion_capture_run.trc",
        "rajagopal_walk_run/static_run.trc",
        72.84,
        "rajagopal_walk_run/grf_run.mot",
    ),
    "overground run": RealWalk(
        "bmc_walk_run/run.trc", "bmc_walk_run/run_static.trc", 70.0, "bmc_walk_run/run_grf.mot"
    ),
}

FURTHER_WALKS = {
    "treadmill walk": RealWalk(
        "gait2354_walk/subject01_walk1.trc",
        "gait2354_walk/subject01_static.trc",
        72.6,
        "gait2354_walk/subject01_walk1_grf.mot",
    ),
    "slow walk": RealWalk("rehazenter_walk/2014001_C1_01.c3d", "rehazenter_walk/2014001_ST_static.c3d", 67.0),
}

LAG_S, RUN_LAGGED_PERCENT = 0.06, 16.0
RUN_SMOOTHED_PERCENT, BELT_WALK_SMOOTHED_PERCENT = 13.0, 5.0
SPREAD, COVER = (0.7, 1.3), (90.0, 98.0)
"""RMS of error over stated standard deviation, and share of errors within the stated 95 % intervals, %."""

PHASES = ("single support", "double support", "run")


@dataclass(frozen=True)
class Judged:
    """One capture without plates.

    Attributes:
        total_percent: RMS of the vertical force on both feet, % of body weight.
        stance_percent: The same of a foot that bears.
        over_sd: By phase: vertical errors over their stated standard deviations.
    """

    total_percent: float
    stance_percent: float
    over_sd: dict[str, Array]


def running_rows(context: Context) -> list[Check]:
    """The rows of the table."""
    data = context.require_data()
    return [*(check for mode in PASSES for check in _rows(data, mode)), _lagged_row(data)]


def phases(
    truth: Reconstruction, found: Reconstruction, runs: bool, until_s: float = np.inf
) -> dict[str, Array]:
    """Vertical errors over stated spreads of feet that bear, by phase.

    Args:
        truth: With the plates.
        found: Without them.
        runs: Whether the person runs.
        until_s: Time after the first frame until which contacts are truly measured.
    """
    assert truth.foot_contact is not None and found.foot_wrench_sd is not None  # the dynamic filter's
    vertical = truth.foot_wrench[:, :, 2]
    judged = truth.measured & (truth.foot_contact >= 0).all(axis=1) & found.tracked
    judged &= truth.times_s - truth.times_s[0] < until_s
    bears = judged[:, None] & (truth.foot_contact == Contact.MEASURED) & (vertical > BEARS_N)
    over_sd = (found.foot_wrench[:, :, 2] - vertical) / found.foot_wrench_sd[:, :, 2]
    if runs:
        return {"run": over_sd[bears]}
    both = bears.all(axis=1)
    return {"single support": over_sd[bears & ~both[:, None]], "double support": over_sd[both].ravel()}


def _judged(data: Path, name: str, walk: RealWalk, mode: str) -> Judged:
    """One capture.

    Args:
        data: Folder of the reference captures.
        name: Its name.
        walk: The capture.
        mode: causal or smoothed.
    """
    until_s = MEASURED_UNTIL_S.get(name, np.inf)
    subject, trial = read_walk(data, walk)
    measured = reconstruct(trial, subject, settings=ReconstructSettings(smooth=PASSES[mode]))
    found = without_plates(trial, subject, ReconstructSettings(smooth=PASSES[mode]))
    off = compared(measured, found, subject, until_s)
    return Judged(off.total, off.stance, phases(measured, found, name in RUNS, until_s))


def _lagged_row(data: Path) -> Check:
    """The treadmill run with a lag of 60 ms."""
    subject, trial = read_walk(data, RUNS["treadmill run"])
    measured = reconstruct(trial, subject, settings=ReconstructSettings(smooth=True))
    found = without_plates(trial, subject, ReconstructSettings(lag_s=LAG_S))
    total = compared(measured, found, subject).total
    return Check("no plates, 60 ms, treadmill run: total vertical", total, RUN_LAGGED_PERCENT, "<=", "% BW")


def _rows(data: Path, mode: str) -> Iterator[Check]:
    """All captures of one pass."""
    title, spreads = f"no plates, {mode}", {phase: dict[str, Array]() for phase in PHASES}
    for name, walk in {**REAL_WALKS, **FURTHER_WALKS, **RUNS}.items():
        one = _judged(data, name, walk, mode)
        for phase, over_sd in one.over_sd.items():
            spreads[phase][name] = over_sd
        bound = np.inf
        if mode == "smoothed" and name == "treadmill run":
            bound = RUN_SMOOTHED_PERCENT
        elif mode == "smoothed" and name in FURTHER_WALKS:
            bound = BELT_WALK_SMOOTHED_PERCENT
        if name not in REAL_WALKS:
            yield Check(f"{title}, {name}: total vertical", one.total_percent, bound, "<=", "% BW")
            yield information(f"{title}, {name}: per foot over stance", one.stance_percent, "% BW")
    for phase, found in spreads.items():
        yield from _spread_rows(f"{title}, {phase}", found)


def _spread_rows(label: str, over_sd: dict[str, Array]) -> Iterator[Check]:
    """Every capture of a phase counts alike.

    Args:
        label: Beginning of the rows' names.
        over_sd: By capture: errors over stated standard deviations.
    """
    sizes = {name: rms(values) for name, values in over_sd.items()}
    covers = [100.0 * float((np.abs(values) <= 1.96).mean()) for values in over_sd.values()]
    for name, size in sizes.items():
        yield information(f"{label}, {name}: error over stated sd", size)
    yield from within(f"{label}: error over stated sd", rms(np.array(list(sizes.values()))), *SPREAD)
    yield from within(f"{label}: errors within their 95 % intervals", float(np.mean(covers)), *COVER, "%")
