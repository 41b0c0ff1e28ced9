"""The filters on real captures: how well they fit, what Newton's law lacks, and how they lag behind the smoother.

There is no truth here. Delay and noise are told against the smoothed dynamic filter, the best that is known of these
trials. The public captures with plates are walks and runs; of squats, jumps and turns there is none among them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import SOURCES, load, present
from benchmarks.dynamic.methods import Mapper, Method
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, SMOOTHED
from benchmarks.full_body.scores import (
    SETTLING_S,
    innovation,
    leg_columns,
    marker_error_mm,
    noise,
    plain_rms,
    posture_error,
    prediction_residual_n,
)
from benchmarks.references import rms
from benchmarks.thesis_report.contents import Findings, Row, Sheet
from benchmarks.thesis_report.delay import delay
from mbkf.io.results import Reconstruction
from mbkf.synthesis.person import body_of
from mbkf.trial.results.summary import ROOT_DOFS

QUICK_CAPTURES = ("rajagopal walk",)

LOST_MM = 50.0
"""A filter whose body is this far from the markers (RMS), or nowhere, has lost the trial."""

REFERENCE = f"{DYNAMIC}, smoothed"


@dataclass(frozen=True)
class RealScores:
    """Numbers of one filter on one capture.

    Attributes:
        capture, filter: Names.
        marker_mm: RMS distance of measured markers from the body.
        angle_from_fcdi_deg: RMS difference of the joints' angles from FCDI's.
        velocity_delay_ms, torque_delay_ms: By how much the legs' curves lag behind the smoothed dynamic filter's.
        velocity_noise_rad_s: What the legs' velocities differ from those above 6 Hz, RMS.
        residual_before_n, residual_n: Force that Newton's law lacks before and after correction, RMS.
        nis: Normalised innovation squared per reading.
        untracked: Frames without the body.
    """

    capture: str
    filter: str
    marker_mm: float
    angle_from_fcdi_deg: float
    velocity_delay_ms: float
    torque_delay_ms: float
    velocity_noise_rad_s: float
    residual_before_n: float
    residual_n: float
    nis: float
    untracked: int

    @property
    def lost(self) -> bool:
        """Whether the filter lost the trial."""
        return not (self.marker_mm <= LOST_MM and np.isfinite(self.angle_from_fcdi_deg))


EVERY: Mapping[str, Method] = {**CAUSAL, **SMOOTHED}
QUICK: Mapping[str, Method] = {name: EVERY[name] for name in (FCDI, DYNAMIC, REFERENCE)}
"""The least that gives every number."""


def measure_capture(name: str, data: Path, methods: Mapping[str, Method] = EVERY) -> list[RealScores]:
    """Several filters on a capture.

    Args:
        name: Name in :data:`benchmarks.dynamic.captures.SOURCES`.
        data: Folder of the reference captures.
        methods: The filters by name, FCDI and the smoothed dynamic filter among them.
    """
    person = load(name, data)
    with np.errstate(all="ignore"):
        runs = {label: method.run(person.capture, person.subject) for label, method in methods.items()}
        return [_scored(name, label, run, runs[FCDI], runs[REFERENCE]) for label, run in runs.items()]


def _scored(
    capture: str, label: str, run: Reconstruction, fcdi: Reconstruction, reference: Reconstruction
) -> RealScores:
    model = body_of(run.subject)
    legs = leg_columns(model) + ROOT_DOFS
    known = np.isfinite(reference.tau[:, legs]).all(axis=1) & np.isfinite(fcdi.tau[:, legs]).all(axis=1)
    known &= reference.tracked & fcdi.tracked
    whole = slice(*(int(np.flatnonzero(known)[k]) + one for k, one in ((0, 0), (-1, 1))))
    times, judged = run.times_s, known & (run.times_s >= run.times_s[0] + SETTLING_S)
    angle = np.rad2deg(plain_rms(posture_error(model, fcdi.q, run.q)[judged][:, ROOT_DOFS:]))
    lags = [
        delay(times[whole], getattr(reference, curve)[whole, legs], getattr(run, curve)[whole, legs])
        for curve in ("v", "tau")
    ]
    return RealScores(
        capture,
        label,
        marker_error_mm(run),
        float(angle),
        1e3 * lags[0],
        1e3 * lags[1],
        noise((run.v - reference.v)[whole, legs], judged[whole], run.rate_hz),
        prediction_residual_n(model, run, fcdi.foot_wrench),
        rms(np.linalg.norm(run.residual_force_n[run.measured], axis=1)),
        innovation(run, judged),
        int((~run.tracked).sum()),
    )


def real_scores(data: Path | None, mapper: Mapper, *, quick: bool) -> list[RealScores]:
    """All filters on all captures that are there; a few filters on one capture when quick.

    Args:
        data: Folder of the public captures; None without any.
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether to do a shorter run.
    """
    methods = QUICK if quick else EVERY
    if data is None:
        return []
    names = present(captures(quick), data)
    found = mapper(partial(measure_capture, data=data, methods=methods), names)
    return [one for part in found for one in part]


def captures(quick: bool) -> tuple[str, ...]:
    """Names of the real captures of a run."""
    return QUICK_CAPTURES if quick else tuple(SOURCES)


def real_findings(scores: Sequence[RealScores]) -> Findings:
    """The table of the real captures; nothing without any."""
    if not scores:
        return Findings()
    columns = (
        "capture",
        "filter",
        "markers (mm)",
        "angles, difference from FCDI (°)",
        "velocity delay (ms)",
        "torque delay (ms)",
        "velocity noise (rad/s)",
        "residual before (N)",
        "residual after (N)",
        "NIS per reading",
        "frames not followed",
    )
    rows: list[Row] = []
    for one in scores:
        numbers = [
            one.marker_mm,
            one.angle_from_fcdi_deg,
            one.velocity_delay_ms,
            one.torque_delay_ms,
            one.velocity_noise_rad_s,
            one.residual_before_n,
            one.residual_n,
            one.nis,
        ]
        shown = [float("nan")] * len(numbers) if one.lost else numbers
        rows.append(
            (
                one.capture,
                one.filter + (" (lost the trial)" if one.lost else ""),
                *shown,
                float(one.untracked),
            )
        )
    note = (
        "Delay and noise against the smoothed dynamic filter. Residual: force that Newton's law lacks with the "
        "measured plates, before: predicted from the frame before. NIS counts readings of different kinds, so it "
        "compares trials, not filters."
    )
    return Findings(sheets=[Sheet("real_captures", "Real captures", columns, tuple(rows), note)])
