"""The paper's four simulated cases: its numbers, its method as printed, ours, and the Kalman filter's."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.stride_paper import printed
from benchmarks.stride_paper.errors import DELAYS_S, KALMAN, KEY_POINTS, PHASES, PRINTED, Study
from benchmarks.stride_paper.printed import ALIGNED, AS_STUDIED
from benchmarks.thesis_report.contents import OPEN, Band, Claim, Findings, Row, Sheet, redone

FINAL_M, MEAN_M = 0.15, 0.08
"""Bounds for key points whose windows are aligned with the motion."""

KALMAN_FINAL_M, KALMAN_MEAN_M = 0.03, 0.015

MOST_DRAWS = 0.75
"""Share of the draws in which an effect has to show; half of them do by chance."""

EQUAL_M = 0.02
"""A result is reproduced that differs by no more from the printed one."""

_FIGURES = {"clean": "Figure 5", "noise": "Figure 6", "drift": "Figure 7", "noise and drift": "Figure 8"}


def case_findings(study: Study, seeds: int) -> Findings:
    """Bounds, table and verdicts of the four cases.

    Args:
        study: Errors of all methods.
        seeds: Number of seeds of the noise.
    """
    claims = [_value_claim(study, case) for case in study.cases]
    claims += [_order_claim(study, case) for case in study.cases if case != "clean"]
    return Findings(list(_bands(study, seeds)), [_sheet(study)], claims)


def _bands(study: Study, seeds: int) -> Iterator[Band]:
    for case in study.cases:
        final, mean = study.largest(KEY_POINTS, case, ALIGNED)
        head = f"{case}, aligned windows, {seeds} seeds"
        yield Band(
            "key points", f"{head}: final (paper {printed.FINAL_M[case]})", final, -OPEN, FINAL_M, "m", False
        )
        yield Band(
            "key points", f"{head}: mean (paper {printed.MEAN_M[case]})", mean, -OPEN, MEAN_M, "m", False
        )
    for case in study.cases:
        final, mean = study.worst_phase(KALMAN, case)
        head = f"{case}, {len(DELAYS_S)} phases, {seeds} seeds"
        yield Band("Kalman filter", f"{head}: final", final, -OPEN, KALMAN_FINAL_M, "m", False)
        yield Band("Kalman filter", f"{head}: mean", mean, -OPEN, KALMAN_MEAN_M, "m", False)


def _sheet(study: Study) -> Sheet:
    rows: list[Row] = []
    for which, name, paper in ((0, "final", printed.FINAL_M), (1, "mean", printed.MEAN_M)):
        for case in study.cases:
            rows.append(
                (
                    f"{case}, {name}",
                    paper[case],
                    study.typical(PRINTED, case, AS_STUDIED)[which],
                    study.typical(PRINTED, case, ALIGNED)[which],
                    study.largest(PRINTED, case, ALIGNED)[which],
                    study.worst_phase(PRINTED, case)[which],
                    study.typical(KEY_POINTS, case, AS_STUDIED)[which],
                    study.largest(KEY_POINTS, case, ALIGNED)[which],
                    study.worst_phase(KEY_POINTS, case)[which],
                    study.worst_phase(KALMAN, case)[which],
                )
            )
    columns = (
        "case and error", "paper", "as printed, paper's windows", "as printed, aligned", "largest of the seeds",
        "as printed, worst phase", "ours, paper's windows", "ours, aligned, largest", "ours, worst phase",
        "Kalman filter, worst phase",
    )  # fmt: skip
    note = (
        "Errors along x in m of two steps of 1 m: median of the seeds, or the largest. The paper ran one signal per "
        "case. Its 248 samples are second differences of 250 positions, so its windows begin one sample after the "
        "motion's; aligned windows begin with the motion. Ours: zero velocity at key points, bias of the first rest."
    )
    return Sheet("cases", "Simulated walk, four cases", columns, tuple(rows), note)


def _value_claim(study: Study, case: str) -> Claim:
    final, mean = printed.FINAL_M[case], printed.MEAN_M[case]
    by_phase = np.array([study.typical(PRINTED, case, phase) for phase in PHASES])
    same = bool((np.abs(by_phase - [final, mean]).max(axis=1) <= EQUAL_M).any())
    studied, aligned, least = by_phase[AS_STUDIED], by_phase[ALIGNED], by_phase.min(axis=0)
    measured = (
        f"As printed {studied[0]:.2f} and {studied[1]:.2f} m with the paper's windows, {aligned[0]:.2f} and "
        f"{aligned[1]:.2f} m with windows aligned with the motion; over ten phases of windows at least "
        f"{least[0]:.2f} and {least[1]:.2f}, at most {by_phase[:, 0].max():.1f} and {by_phase[:, 1].max():.1f} m. A "
        "shift of the windows by one sample changes the result more than noise and drift do, and the paper does not "
        "state where they lie."
    )
    return Claim(
        _FIGURES[case], f"{case.capitalize()}: final error {final} m, mean {mean} m.", measured, redone(same)
    )


def _order_claim(study: Study, case: str) -> Claim:
    """The claim that an error of the sensors makes the mean error larger."""
    medians = {one: study.typical(PRINTED, one, ALIGNED)[1] for one in study.cases}
    studied = [study.typical(PRINTED, one, AS_STUDIED)[1] for one in ("clean", case)]
    errors = study.errors[PRINTED, case][ALIGNED][:, 1]
    share = float((errors > medians["clean"]).mean())
    measured = (
        f"As printed, aligned windows: mean error {medians['clean']:.3f} m clean, here {medians[case]:.3f} m in the "
        f"median of {len(errors)} draws ({errors.min():.3f} to {errors.max():.3f}); larger than clean in "
        f"{100 * share:.0f} % of them (reproduced from {100 * MOST_DRAWS:.0f} % on). Draws are seeds of the noise and "
        f"directions of the gyroscope's constant. With the paper's windows {studied[0]:.3f} and {studied[1]:.3f} m."
    )
    worst = medians[case] == max(medians.values())
    same = share >= MOST_DRAWS and (worst if case == printed.BOTH else medians[case] > medians["clean"])
    statement = (
        f"Noise and drift together are worst of all: mean error {printed.MEAN_M[case]} m."
        if case == printed.BOTH
        else f"{case.capitalize()} raises the mean error from {printed.MEAN_M['clean']} to {printed.MEAN_M[case]} m."
    )
    return Claim(_FIGURES[case], statement, measured, redone(same))
