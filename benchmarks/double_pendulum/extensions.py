"""Extensions of the thesis: a backward smoother, artefact states, and the filter in acceleration coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.double_pendulum.acceleration import AccelerationMethod, AccelerationSettings
from benchmarks.double_pendulum.kinematic import KinematicMethod
from benchmarks.double_pendulum.laboratory import Laboratory, Pair
from benchmarks.double_pendulum.motions import PendulumNoise
from benchmarks.double_pendulum.pendulum import PendulumShape
from benchmarks.double_pendulum.studies import NO_ARTEFACT, WRONG, with_model
from benchmarks.double_pendulum.sweeps import Sweeps, with_noise
from benchmarks.double_pendulum.thesis import (
    ANNEX,
    ANNEX_RECIPE,
    FCDI,
    FD,
    FDMC,
    KINEMATIC_ACCELERATION,
    STUDY,
    STUDY_RECIPE,
    annex_method,
)
from benchmarks.double_pendulum.torque import Artefact
from benchmarks.double_pendulum.trials import Method, Recipe, Scores
from benchmarks.thesis_report.contents import OPEN, Band, Findings, Row, Sheet
from mbkf.conventions import Array

SMOOTHED_NOISE = 100.0
"""σ_P of the smoother, which need not follow quickly because it looks ahead."""

ARTEFACT_NOISE = 2000.0
"""σ_P with artefact states, whose smaller marker noise makes the filter follow faster."""

CAMERA_M = 1e-4
"""Marker noise with artefact states, which leave only the camera's to it."""

IN_ACCELERATIONS = AccelerationMethod(STUDY)

OWN = "acceleration coordinates"
ALIKE = 0.03
"""Ratios this close to 1 are no difference."""


def artefact_method(order: int) -> Method:
    """FD with artefact states."""
    settings = replace(
        FD.settings, effort_noise=ARTEFACT_NOISE, marker_m=CAMERA_M, artefact=Artefact(order=order)
    )
    return replace(FD, settings=settings)


def smoother_findings(lab: Laboratory) -> Findings:
    """The smoother against the same filter without it."""
    causal = with_noise(SMOOTHED_NOISE)
    pairs = [Pair(STUDY_RECIPE, one) for one in (causal, replace(causal, smooth=True))]
    before, after = lab.measure("Backward smoother", pairs)
    row = "backward smoother, σ_P = 100"
    delay = abs(float(after.torque_delay_ms.mean()))
    return Findings(
        [
            Band(row, "τ_1", float((after.torque / before.torque).mean()), -OPEN, 0.45, "×"),
            Band(row, "ż", float((after.velocity / before.velocity).mean()), -OPEN, 0.8, "×"),
            Band(row, "|delay of τ_1|", delay, -OPEN, 2.0, "ms"),
        ]
    )


def artefact_findings(lab: Laboratory, sweeps: Sweeps) -> Findings:
    """Gauss–Markov artefact states against the standard filter at the best σ_P of each quantity."""
    (states,) = lab.measure("Artefact states", [Pair(STUDY_RECIPE, artefact_method(1))])
    row = "Gauss–Markov artefact states"
    bands = []
    for name, title, limit in (("velocity", "ż", 0.7), ("torque", "τ_1", 0.9)):
        sweep = sweeps.dynamic["sin"]
        best: Array = getattr(sweep.scores[int(np.argmin(sweep.mean(name)))], name)
        ratio = float((getattr(states, name) / best).mean())
        bands.append(Band(row, f"{title} over the best standard filter's", ratio, -OPEN, limit, "×"))
    return Findings(bands)


def own_findings(lab: Laboratory) -> Findings:
    """All filters on all trials: where the filter in acceleration coordinates is better, and where not."""
    sheets: list[Sheet] = []
    summary: list[Row] = []
    compared = _comparisons()
    groups = [[Pair(recipe, one) for one in methods.values()] for _, _, recipe, methods in compared]
    scores = lab.measure_groups("All filters", groups)
    for (title, name, recipe, methods), found in zip(compared, scores, strict=True):
        rows: tuple[Row, ...] = tuple(
            (label, *_row(one, found[0], recipe.lost_bar > 0))
            for label, one in zip(methods, found, strict=True)
        )
        summary.append((title, *_own_row(dict(zip(methods, found, strict=True)))))
        sheets.append(Sheet(f"filters_{name}", f"All filters: {title}", _columns(recipe.lost_bar > 0), rows))
    return Findings(sheets=[_own_sheet(summary), *sheets])


def _own_row(found: dict[str, Scores]) -> Row:
    """Errors of the filter in acceleration coordinates over FD's, and its torque over FCDI's; what that means."""
    own, names = found[OWN], {"position": "z", "velocity": "ż", "torque": "τ_1"}
    ratios = {
        title: float((getattr(own, key) / getattr(found["FD"], key)).mean()) for key, title in names.items()
    }
    kinematic = float((own.torque / found["FCDI"].torque).mean())
    better = ", ".join(title for title, ratio in ratios.items() if ratio < 1.0 - ALIKE)
    worse = ", ".join(title for title, ratio in ratios.items() if ratio > 1.0 + ALIKE)
    delays = (float(own.torque_delay_ms.mean()), float(found["FD"].torque_delay_ms.mean()))
    return (*ratios.values(), kinematic, *delays, better or "nothing", worse or "nothing")


def _own_sheet(rows: Sequence[Row]) -> Sheet:
    columns = (
        "trials",
        "z × FD",
        "ż × FD",
        "τ_1 × FD",
        "τ_1 × FCDI",
        "its delay of τ_1 (ms)",
        "FD's",
        "better than FD in",
        "worse in",
    )
    title = "The filter in acceleration coordinates, same trials and noise"
    note = f"Mean ratios of RMS errors, paired by seed; within {100 * ALIKE:.0f} % counts as alike."
    return Sheet("own_filter", title, columns, tuple(rows), note)


def _comparisons() -> list[tuple[str, str, Recipe, dict[str, Method]]]:
    """Title, file name, trials and filters of each table; the first filter is what others are compared with."""
    with_loss = [
        (
            f"bar {bar} lost, {'with' if noise.artefact_m else 'without'} artefact",
            f"lost_{bar}_{'with' if noise.artefact_m else 'without'}",
            Recipe("sin", STUDY, noise, bar),
            _causal(STUDY),
        )
        for bar in (1, 2)
        for noise in (PendulumNoise(), NO_ARTEFACT)
    ]
    annex: dict[str, Method] = {
        "FD": annex_method("TN EX VL"),
        "FDMC": annex_method("FE SE CT", complete=False),
        OWN: AccelerationMethod(ANNEX, AccelerationSettings(force_n=0.05, moment_nm=0.05)),
        "FCDI": KinematicMethod(ANNEX, KINEMATIC_ACCELERATION),
    }
    return [
        ("Table A.2's trials", "annex", ANNEX_RECIPE, annex),
        ("sin", "sin", STUDY_RECIPE, _all(STUDY)),
        ("squat", "squat", Recipe("squat", STUDY), _all(STUDY)),
        ("wrong masses", "masses", STUDY_RECIPE, _causal(WRONG)),
        *with_loss,
    ]


def _causal(shape: PendulumShape) -> dict[str, Method]:
    """The filters of the thesis, and the filter in acceleration coordinates."""
    return {
        "FD": with_model(FD, shape, 1e-3),
        "FDMC": with_model(FDMC, shape, 1e-3),
        OWN: replace(IN_ACCELERATIONS, shape=shape),
        "FCDI": replace(FCDI, shape=shape),
    }


def _all(shape: PendulumShape) -> dict[str, Method]:
    """The causal filters, artefact states and smoothers."""
    return _causal(shape) | {
        "FD, artefact states (1st order)": artefact_method(1),
        "FD, artefact states (2nd order)": artefact_method(2),
        "FD smoothed, σ_P = 100": replace(with_noise(SMOOTHED_NOISE), smooth=True),
        "acceleration coord., smoothed": replace(IN_ACCELERATIONS, shape=shape, smooth=True),
    }


def _columns(lost: bool) -> tuple[str, ...]:
    errors = ("RMS z", "RMS ż", "RMS τ_1 (N m)")
    parts = tuple(f"{name}{part}" for name in errors for part in ("", " ±", ", × FD"))
    gap = ("angle in the gap (rad)", "τ_1 after it (N m)") if lost else ()
    return ("filter", *parts, "delay of ż (ms)", "delay of τ_1 (ms)", *gap)


def _row(one: Scores, reference: Scores, lost: bool) -> tuple[float, ...]:
    cells: list[float] = []
    for name in ("position", "velocity", "torque"):
        values: Array = getattr(one, name)
        ratio = values / getattr(reference, name)
        cells += [float(values.mean()), float(values.std(ddof=1)), float(ratio.mean())]
    cells += [float(one.delay_ms.mean()), float(one.torque_delay_ms.mean())]
    if lost:
        cells += [float(one.gap_angle.mean()), float(one.torque_after.mean())]
    return tuple(cells)
