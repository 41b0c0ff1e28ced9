"""Bounds, tables and verdicts of the steps: the paper's real experiments in kind, and its remarks on real signals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.inertial.stride_measured import Compared
from benchmarks.stride_paper import printed
from benchmarks.stride_paper.steps import KALMAN, Estimated, LateStart, Signals
from benchmarks.thesis_report.contents import CANNOT_BE_HAD, OPEN, Band, Claim, Findings, Row, Sheet, redone

AS_PRINTED = "as printed"
KALMAN_M, LEAST_GROWTH, LEAST_BIAS = 0.05, 1.5, 2.0

_FIGURES = {"one step": "Figure 9", "two steps": "Figure 10"}


def step_findings(
    estimated: Sequence[Estimated],
    late: Sequence[LateStart] = (),
    found: Signals | None = None,
    compared: Sequence[Compared] = (),
) -> Findings:
    """Everything about steps.

    Args:
        estimated: Every method on every recording.
        late: Recordings that begin later; empty without captures.
        found: Numbers of the whole capture; None without captures.
        compared: Strides of the whole capture by every method; empty without captures.
    """
    bands = [
        Band("steps", f"{one.recording.name}, {one.recording.kind}: error of the Kalman filter", one.rms_m, -OPEN,
             KALMAN_M, "m", False)
        for one in estimated
        if one.method == KALMAN and one.recording.measured
    ]  # fmt: skip
    claims = [_step_claim(kind, estimated) for kind in printed.STEPS_M]
    sheets = [_step_sheet(estimated), _stride_sheet(compared)]
    if late:
        on_time = late[0]
        growth = on_time.rms_m["velocity runs through rests"] / on_time.rms_m["ours"]
        bands += [
            Band("why drift harms", "measured steps, windows of 5: growth of the error by stride eq. 6 as printed",
                 growth,
                 LEAST_GROWTH, OPEN, "", False),
            Band("why drift harms", "measured steps, latest start: bias error, first second over first rest",
                 late[-1].bias_rad_s["first second"] / late[-1].bias_rad_s["first rest"], LEAST_BIAS, OPEN, "", False),
        ]  # fmt: skip
        sheets.append(_late_sheet(late))
        claims += [_bias_claim(late), _velocity_claim(late)]
    if found is not None:
        claims += _signal_claims(found)
    return Findings(bands, sheets, claims)


def _step_sheet(estimated: Sequence[Estimated]) -> Sheet:
    rows: list[Row] = []
    for kind, lengths in printed.STEPS_M.items():
        expected, paper = sum(lengths), printed.STEPS_ESTIMATED_M[kind]
        nowhere = float("nan")
        rows.append(
            (f"paper, {kind}", "as the paper ran it", expected, paper, nowhere, nowhere, expected - paper)
        )
        for one in estimated:
            if one.recording.kind == kind:
                lengths_m = one.lengths_m
                rows.append(
                    (
                        f"{one.recording.name}, {kind}",
                        one.method,
                        one.recording.length_m,
                        float(lengths_m[0]),
                        float(lengths_m.min()),
                        float(lengths_m.max()),
                        one.rms_m,
                    )
                )
    columns = (
        "recording", "method", "true m", "estimated m", "least of 10 phases", "largest", "RMS error m",
    )  # fmt: skip
    note = (
        "The paper's recordings are not public. Simulated: its lengths, steps of 1.1 s and rests of 1.1 s at 50 Hz. "
        "gaitmap: a healthy person's first steps from standing, steps of 0.8 to 1 s, rests of 0.2 s, 204.8 Hz, heel "
        "by cameras. Weights 0.2, 0.4, 0.4, low pass 15 Hz."
    )
    return Sheet("steps", "One step and two steps", columns, tuple(rows), note)


def _stride_sheet(compared: Sequence[Compared]) -> Sheet:
    rows: tuple[Row, ...] = tuple(
        (
            one.name,
            f"{one.found} of {len(one.reference_m)}",
            one.rmse_mm,
            one.mean_mm,
            float(np.nanmedian(one.errors_mm)),
            float(np.nanmax(np.abs(one.errors_mm))),
            one.normalised,
        )
        for one in compared
    )
    columns = (
        "method", "strides found", "RMSE mm", "mean mm", "median mm", "largest mm", "squared error / stated variance",
    )  # fmt: skip
    note = (
        "The capture's whole walk; bounds stand in the benchmark inertial. The cameras' events only select rests. "
        "One stride of 0.47 m is a turn on the spot, in which the heel goes 17 cm further than the sensor. Sensors "
        "clip heel strikes at 16 g."
    )
    return Sheet("measured_strides", "Strides measured by cameras", columns, rows, note)


def _late_sheet(late: Sequence[LateStart]) -> Sheet:
    rows: tuple[Row, ...] = tuple(
        (
            one.start_s,
            *(float(np.degrees(value)) for value in one.bias_rad_s.values()),
            *one.rms_m.values(),
        )
        for one in late
    )
    columns = (
        "start s",
        *(f"error of the bias, {source} °/s" for source in late[0].bias_rad_s),
        *(f"{name} m" for name in late[0].rms_m),
    )
    note = (
        "Measured steps, windows of 5 carried sample by sample, which of three variants err least on the strides of "
        "this capture; RMS error over both feet, one and two steps, ten phases. Starts after 0 s leave less standing "
        "before the first step. True bias: standing at the end of the capture."
    )
    return Sheet("late_starts", "The paper's choices on measured steps", columns, rows, note)


def _step_claim(kind: str, estimated: Sequence[Estimated]) -> Claim:
    expected, paper = sum(printed.STEPS_M[kind]), printed.STEPS_ESTIMATED_M[kind]
    own = [one for one in estimated if one.recording.kind == kind]
    texts = [
        f"{one.recording.name} {one.lengths_m[0]:.2f} ({one.lengths_m.min():.2f} to {one.lengths_m.max():.2f}) of "
        f"{one.recording.length_m:.2f} m"
        for one in own
        if one.method == AS_PRINTED
    ]
    kalman = [abs(one.errors_m[0]) for one in own if one.method == KALMAN]
    measured = (
        "The recordings are not public. Stand-ins, as printed, with windows from the first sample (over ten phases): "
        + "; ".join(texts)
        + f". The Kalman filter errs by {min(kalman):.3f} to {max(kalman):.3f} m."
    )
    return Claim(_FIGURES[kind], f"{paper} m estimated of {expected:.2f} m walked.", measured, CANNOT_BE_HAD)


def _bias_claim(late: Sequence[LateStart]) -> Claim:
    worst = max(np.degrees(one.bias_rad_s["first second"]) for one in late)
    rest = max(np.degrees(one.bias_rad_s["first rest"]) for one in late)
    first = np.degrees(late[0].bias_rad_s["first second"])
    change = [one.rms_m["bias of the first second"] - one.rms_m["ours"] for one in late]
    measured = (
        "Only if the foot stands for all of it. The measured feet begin to move after 0.9 to 1 s: the first "
        f"second's mean errs by {first:.1f}°/s, by {worst:.0f}°/s if the recording begins later; that of the first "
        f"rest by {rest:.1f}°/s at most. Lengths change by {1e3 * min(change):+.0f} to {1e3 * max(change):+.0f} mm, "
        "since gravity carried from both sides cancels most of a constant."
    )
    return Claim(
        "Real signals", "The mean of the first second, before the walk, takes the drift away.", measured,
        redone(worst < 1.0),
    )  # fmt: skip


def _velocity_claim(late: Sequence[LateStart]) -> Claim:
    ours, printed_m = (late[0].rms_m[name] for name in ("ours", "velocity runs through rests"))
    measured = (
        f"Measured steps: {printed_m:.2f} m RMS with stride eq. 6, {ours:.2f} m with zero velocity at key points, both "
        "with windows of 5 carried sample by sample (windows of 10 err more in either way: table of the steps). Rests "
        "of a walk hold the velocity's error for as long as they last."
    )
    return Claim(
        "stride eq. 6", "The position is the double integral of the acceleration.", measured,
        redone(printed_m <= ours),
    )  # fmt: skip


def _signal_claims(found: Signals) -> list[Claim]:
    spectrum = (
        f"A foot's specific force in walking (gaitmap): {100 * found.below_5_hz:.0f} % of its variance below 5 Hz, "
        f"{100 * found.below_15_hz:.0f} % below 15 Hz; heel strikes hold the rest."
    )
    times = f"gaitmap: strides of {found.stride_s:.2f} s, {100 * found.swing:.0f} % swing."
    others = (
        f"A Kalman filter with zero-velocity updates and a smoother errs by {found.stride_rmse_mm:.0f} mm RMS on "
        f"{found.strides} strides measured by cameras, from the same two sensors."
    )
    return [
        Claim("Real signals", "Accelerations of gait lie below 5 Hz.", spectrum, redone(found.below_5_hz > 0.5)),
        Claim("Method", "A stride takes 2 s, of which 40 % are swing.", times,
              redone(abs(found.swing - 0.4) < 0.05 and abs(found.stride_s - 2.0) < 0.4)),
        Claim("Introduction", "Estimates without further sensors have not been effective.", others,
              redone(found.stride_rmse_mm > 50.0)),
    ]  # fmt: skip
