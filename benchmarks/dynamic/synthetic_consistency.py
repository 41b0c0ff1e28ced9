"""Consistency of a filter with default settings on synthetic captures: NEES, coverage and NIS, without bounds.

There is no bound, since a squat is planned motion and no random walk as in the filter's plant, and the default settings
expect skin artefacts. `benchmarks.dynamic.consistency` bounds the filter where motion and noise match its model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.methods import Mapper, Method, rows_or_failure
from benchmarks.dynamic.synthetic import MATCHED, Case, differences, make_case
from mbkf.conventions import Array
from mbkf.trial.results.innovations import SETTLING_S
from mbkf.trial.results.summary import ROOT_DOFS, compare_with_truth

_TWO_SIDED_95 = 1.959964


@dataclass(frozen=True)
class CaseConsistency:
    """Consistency of a filter's errors with its covariance, per dof and over settled frames.

    Attributes:
        nees: Mean of (error / sd)² of positions, velocities and torques.
        coverage: Share of errors inside the 95 % interval, likewise.
        nis: Normalised innovation squared per reading.
        joint_nees: NEES per dof of positions and velocities with their whole covariance; NaN without one.
    """

    nees: tuple[float, float, float]
    coverage: tuple[float, float, float]
    nis: float
    joint_nees: float


def consistency_rows(
    keys: Sequence[tuple[str, int]], methods: Sequence[Method], mapper: Mapper
) -> list[Check]:
    """Camera noise, no artefact, known marker positions, default settings: NEES, NIS and coverage, no bounds.

    Args:
        keys: Motion and seed of each trial.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    trials = mapper(partial(make_case, settings=MATCHED, correct=False), keys)
    rows: list[Check] = []
    for method in methods:
        label = f"defaults, camera noise only: {method.label}"
        rows += rows_or_failure(label, partial(_consistent, label, trials, method, mapper))
    return rows


def _consistent(label: str, trials: Sequence[Case], method: Method, mapper: Mapper) -> list[Check]:
    found = mapper(partial(consistency_of, method=method), trials)
    rows = []
    for k, quantity in enumerate(("positions", "velocities", "torques")):
        nees = float(np.mean([one.nees[k] for one in found]))
        inside = 100.0 * float(np.mean([one.coverage[k] for one in found]))
        rows.append(information(f"{label}, NEES per dof, {quantity}", nees))
        rows.append(information(f"{label}, 95 % intervals cover, {quantity}", inside, "%"))
    nis = float(np.mean([one.nis for one in found]))
    rows.append(information(f"{label}, NIS per reading", nis))
    joint = float(np.mean([one.joint_nees for one in found]))
    return [*rows, information(f"{label}, joint NEES, positions and velocities", joint)]


def consistency_of(case: Case, method: Method) -> CaseConsistency:
    """NEES, coverage and NIS of a method on a case."""
    found = method.run(case.capture, case.subject, keep_covariance=True)
    joint = compare_with_truth(found, case.truth)["nees_per_dof"]
    settled = (found.times_s >= found.times_s[0] + SETTLING_S) & found.tracked
    spreads = (found.sd_q, found.sd_v, found.sd_tau)
    ratios = [
        (error / np.where(sd[:, ROOT_DOFS:] > 0.0, sd[:, ROOT_DOFS:], np.nan))[settled]
        for error, sd in zip(differences(found, case.truth), spreads, strict=True)
    ]
    judged = settled & (found.nis_readings > 0)
    nis = found.nis[judged] / found.nis_readings[judged]
    return CaseConsistency(
        _three([float(np.nanmean(ratio**2)) for ratio in ratios]),
        _three([_share_inside(ratio) for ratio in ratios]),
        float(nis.mean()) if judged.any() else float("nan"),
        float("nan") if joint is None else joint,
    )


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    a, b, c = values
    return a, b, c


def _share_inside(ratio: Array) -> float:
    known = ratio[np.isfinite(ratio)]
    return float((np.abs(known) <= _TWO_SIDED_95).mean()) if known.size else float("nan")
