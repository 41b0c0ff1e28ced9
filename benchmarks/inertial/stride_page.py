"""One self-contained page about stride lengths: the study's numbers beside ours, over the phase of its windows."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.checks import Check
from benchmarks.inertial.cubic_steps import CASES, RATE_HZ, cubic_steps
from benchmarks.inertial.stride_measured import Compared
from benchmarks.inertial.stride_study import (
    ALIGNED,
    AS_STUDIED,
    DELAYS_S,
    FINAL_M,
    KALMAN,
    KEY_POINTS,
    MEAN_M,
    PHASES,
    STUDY_FINAL_M,
    STUDY_MEAN_M,
    Study,
    kalman_path,
    key_points,
    settings_of,
    window_truth,
)
from benchmarks.thesis_report.figures import BLUE, GREEN, ORANGE, TRUTH, axes
from mbkf.imu.key_points import KeyPointSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PAGE = "stride.html"
RED = "#b3261e"
CASE_COLOURS = (TRUTH, BLUE, GREEN, ORANGE)
MISLED = 6
"""A phase at which a window full of acceleration looks stable."""

_STYLE = """
:root { --ink: #1b1f23; --soft: #5b636b; --line: #dfe2e5; --good: #1a7f45; --bad: #b3261e; }
* { box-sizing: border-box; }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); max-width: 1120px; margin: 0 auto; padding: 2rem; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { font-size: 1.25rem; margin: 2.4rem 0 .6rem; }
p { max-width: 46rem; } .soft { color: var(--soft); } .wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th { text-align: left; border-bottom: 2px solid var(--line); vertical-align: bottom; line-height: 1.25; }
td { border-bottom: 1px solid var(--line); } th, td { padding: .3rem .6rem; }
td.n, th.n { text-align: right; } .good { color: var(--good); } .bad { color: var(--bad); }
.good, .bad { font-weight: 600; } figure { margin: 1.2rem 0; max-width: 54rem; } figcaption { font-size: 13px; }
img { width: 100%; height: auto; } @media (max-width: 36rem) { body { padding: 1rem; } }
"""

_LEAD = (
    "The key-point algorithm of the stride-length study, and beside it a Kalman filter with zero-velocity updates and "
    "a backward smoother: on the study's simulated walk, whose truth is known, and on strides that cameras measured."
)
_CASES_NOTE = (
    "Two steps of 1 m; errors along x in metres. The study ran one signal per case and does not state where its "
    "windows lie. Its 248 samples are second differences of 250 positions, which puts its windows one sample after the "
    "motion's start. Ours: median of the seeds, and the largest in brackets."
)
_SWEEP_NOTE = (
    "Errors over the sample at which the first window begins, largest of the seeds. Dashes at the right: what the "
    "study found. Dotted: the bound for aligned windows. The Kalman filter (thick, grey) has no windows; its walk is "
    "delayed against the samples instead, 21 ms per step."
)
_STABILITY_NOTE = (
    "Why: stability S per window in the clean case; blue bars are key points. When the first window of a step holds "
    "only part of it, its mean can happen to equal the next window's. S, in which the change of the mean weighs most, "
    "is then small at full acceleration, and that acceleration is taken for gravity. The Kalman filter has such a "
    "moment, too: in the middle of a step the acceleration passes zero. But it knows its velocity and does not believe "
    "the rest."
)
_POSITIONS_NOTE = (
    "Position along x in the four cases: truth black, key points with aligned windows orange, with the study's windows "
    "red; the Kalman filter, light blue, lies on the truth. Small dots: the truth averaged over windows."
)
_MEASURED_NOTE = (
    "The events of the reference only select rests; lengths are between the rests that each method found "
    "itself. One reference stride (0.47 m) is a turn on the spot, in which the heel, where the camera's marker is, "
    "goes 17 cm further than the sensor. Both sensors clip heel strikes at 16 g."
)
_RESTS_NOTE = (
    "Left: strides of the Kalman filter against the cameras. Right: how long the feet rest in walking. A window that "
    "must lie wholly inside such a rest is often not to be had, which is why the study's algorithm, made for single "
    "steps with pauses, misses strides in ordinary walking."
)

PUBLISHED, BOUNDS = (STUDY_FINAL_M, STUDY_MEAN_M), (FINAL_M, MEAN_M)


def write_page(
    folder: Path,
    study: Study,
    compared: Sequence[Compared],
    checks: Sequence[Check],
) -> None:
    """Writes ``stride.html``.

    Args:
        folder: Where.
        study: Errors on the simulated walk.
        compared: Variants on the measured strides.
        checks: The table of bounds.
    """
    judged = [check for check in checks if check.bounded]
    kept = sum(check.passed for check in judged)
    parts = [
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width, initial-scale=1'>",
        f"<title>Stride lengths</title><style>{_STYLE}</style></head><body>",
        "<h1>Stride length from one sensor on the foot</h1>",
        f"<p>{_LEAD} {kept} of {len(judged)} bounds are kept. <code>python -m benchmarks inertial</code></p>",
        f"<h2>The study's four cases</h2><p class='soft'>{_CASES_NOTE}</p>",
        _study_table(study),
        "<h2>The phase of the windows decides</h2>",
        _picture(_sweep(study), _SWEEP_NOTE),
        _picture(_stability(), _STABILITY_NOTE),
        _picture(_positions(), _POSITIONS_NOTE),
        "<h2>Strides measured by cameras</h2>",
        _measured_table(compared),
        f"<p class='soft'>{_MEASURED_NOTE}</p>",
        _picture(_measured(compared), _RESTS_NOTE),
        "<h2>Bounds</h2>",
        _check_table(checks),
        "</body></html>\n",
    ]
    (folder / PAGE).write_text("\n".join(parts), encoding="utf-8")


def _table(head: Sequence[str], rows: Iterator[Sequence[str]] | Sequence[Sequence[str]]) -> str:
    """First column left, all others right; cells are HTML."""
    kinds = ["", *(" class='n'" for _ in head[1:])]
    heads = "".join(f"<th{kind}>{cell}</th>" for kind, cell in zip(kinds, head, strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td{kind}>{cell}</td>" for kind, cell in zip(kinds, row, strict=True)) + "</tr>"
        for row in rows
    )
    return f"<div class='wide'><table><tr>{heads}</tr>{body}</table></div>"


def _study_table(study: Study) -> str:
    def ours(method: str, case: str, phase: int, which: int) -> str:
        middle, most = study.typical(method, case, phase)[which], study.largest(method, case, phase)[which]
        return f"{middle:.3f} ({most:.3f})"

    rows = [
        [
            f"{case}, {name}",
            f"{PUBLISHED[which][case]:.2f}",
            ours(KEY_POINTS, case, AS_STUDIED, which),
            ours(KEY_POINTS, case, ALIGNED, which),
            f"{max(study.largest(KEY_POINTS, case, phase)[which] for phase in PHASES):.2f}",
            f"{max(study.largest(KALMAN, case, phase)[which] for phase in range(len(DELAYS_S))):.3f}",
        ]
        for case in study.cases
        for which, name in enumerate(("final", "mean"))
    ]
    head = (
        "case and error", "study", "key points, study's windows", "key points, aligned", "key points, worst phase",
        "Kalman, worst phase",
    )  # fmt: skip
    return _table(head, rows)


def _measured_table(compared: Sequence[Compared]) -> str:
    rows = [
        [
            escape(one.name),
            f"{one.found} of {len(one.reference_m)}",
            f"{one.rmse_mm:.1f}",
            f"{one.mean_mm:+.1f}",
            f"{np.nanmedian(one.errors_mm):+.1f}",
            f"{np.nanmax(np.abs(one.errors_mm)):.0f}",
            f"{one.normalised:.2f}" if np.isfinite(one.normalised) else "",
        ]
        for one in compared
    ]
    head = (
        "method", "strides found", "RMSE mm", "mean mm", "median mm", "largest mm", "squared error / stated variance",
    )  # fmt: skip
    return _table(head, rows)


def _check_table(checks: Sequence[Check]) -> str:
    rows = [
        [
            escape(check.name),
            f"{check.value:.4g}",
            f"{escape(check.relation)} {check.bound:g}" if check.bounded else "",
            check.unit,
            ""
            if not check.bounded
            else "<span class='good'>pass</span>"
            if check.passed
            else "<span class='bad'>FAIL</span>",
        ]
        for check in checks
    ]
    return _table(("row", "value", "bound", "unit", ""), rows)


def _sweep(study: Study) -> Figure:
    figure, panels = axes(1, 2, height=3.6)
    for which, (panel, name, bound) in enumerate(zip(panels, ("final", "mean"), BOUNDS, strict=True)):
        for case, colour in zip(study.cases, CASE_COLOURS, strict=True):
            own = [study.largest(KEY_POINTS, case, phase)[which] for phase in PHASES]
            panel.semilogy(PHASES, own, "o-", ms=3, color=colour, lw=1.1, label=case, alpha=0.85)
            level = PUBLISHED[which][case]
            panel.plot([9.4, 10.0], [level, level], "--", color=colour, lw=1.4)
            where = {"noise": "bottom", "drift": "top"}.get(case, "center")
            panel.text(10.1, level, case, fontsize=6, va=where, color=colour)
        kalman = [
            max(study.largest(KALMAN, case, phase)[which] for case in study.cases)
            for phase in range(len(DELAYS_S))
        ]
        panel.plot(PHASES, kalman, color="#9aa0a6", lw=3.0, label="Kalman, worst case")
        panel.axhline(bound, color=RED, ls=":", lw=1.0)
        _labelled(panel, "first sample of the first window", f"{name} error (m)")
        panel.set_xlim(-0.3, 12.4)
        panel.set_xticks(PHASES)
    panels[0].legend(fontsize=7, frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure


def _stability() -> Figure:
    figure, panels = axes(1, 2, height=2.6)
    walk = cubic_steps()
    for panel, first, name in zip(
        panels, (ALIGNED, MISLED), ("aligned", f"begun at sample {MISLED}"), strict=True
    ):
        settings = KeyPointSettings(first=first)
        found = key_points(walk, settings)
        colours = [BLUE if still else "#c9ced3" for still in found.still]
        panel.set_axisbelow(True)
        panel.bar(found.time_s, found.stability, width=0.17, color=colours)
        panel.axhline(settings.threshold, color=RED, lw=1.0)
        acceleration = walk.specific_force_mps2[:, 0]
        panel.plot(walk.time_s, acceleration / 3.0, color=TRUTH, lw=0.8)
        panel.set_title(f"windows {name}", fontsize=9, loc="left")
        panel.set_ylim(-2.3, 3.6)
        _labelled(panel, "time (s)", "S; black: a_x / 3 (m/s²)")
    return figure


def _positions() -> Figure:
    figure, panels = axes(2, 2, height=2.3)
    for panel, case in zip(panels, CASES, strict=True):
        walk = cubic_steps(case, 0)
        panel.plot(walk.time_s, walk.position_m[:, 0], color=TRUTH, lw=2.2)
        panel.plot(walk.time_s, kalman_path(walk), color="#6fb1ea", lw=1.0)
        for first, colour in ((ALIGNED, ORANGE), (AS_STUDIED, RED)):
            settings = settings_of(KEY_POINTS, case, first)
            found = key_points(walk, settings)
            panel.plot(found.time_s, found.position_m[:, 0], "o-", ms=2.5, color=colour, lw=1.0)
            panel.plot(found.time_s, window_truth(walk, settings), ".", ms=1.5, color=TRUTH)
        panel.set_title(case, fontsize=9, loc="left")
        _labelled(panel, "time (s)", "x (m)")
    return figure


def _measured(compared: Sequence[Compared]) -> Figure:
    figure, (left, right) = axes(1, 2, height=3.2)
    best, plain = compared[0], compared[1]
    left.plot([0.2, 1.6], [0.2, 1.6], color=TRUTH, lw=0.8)
    left.errorbar(
        best.reference_m, best.lengths_m, best.sd_m, fmt="o", ms=3, color=BLUE, lw=0.7, label=best.name
    )
    left.plot(plain.reference_m, plain.lengths_m, "x", ms=4, color=ORANGE, label=plain.name)
    left.legend(fontsize=8, frameon=False)
    _labelled(left, "cameras (m)", "sensor (m)")
    inner = best.rests_s[best.rests_s < 0.6]
    right.set_axisbelow(True)
    right.hist(inner, bins=30, range=(0.0, 0.6), color=BLUE)
    right.axvline(10 / RATE_HZ, color=RED, lw=1.2)
    right.set_ylim(0.0, 1.15 * right.get_ylim()[1])
    right.text(10 / RATE_HZ + 0.01, right.get_ylim()[1] * 0.94, "one window", fontsize=8, color=RED)
    _labelled(right, "length of a rest in walking (s)", "rests")
    return figure


def _labelled(panel: Axes, x: str, y: str) -> None:
    panel.set_xlabel(x, fontsize=9)
    panel.set_ylabel(y, fontsize=9)


def _picture(figure: Figure, caption: str) -> str:
    from matplotlib import rc_context

    file = io.BytesIO()
    with rc_context({"svg.hashsalt": caption, "svg.fonttype": "path"}):
        figure.savefig(file, format="svg", metadata={"Date": None})
    data = base64.b64encode(file.getvalue()).decode("ascii")
    return (
        f"<figure><img alt='{escape(caption, quote=True)}' src='data:image/svg+xml;base64,{data}'>"
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )
