"""The paper's figures drawn again with ours beside them, and figures of what decides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.inertial.cubic_steps import CASES, cubic_steps
from benchmarks.inertial.stride_measured import Compared
from benchmarks.stride_paper import printed
from benchmarks.stride_paper.errors import (
    DELAYS_S,
    KALMAN,
    KEY_POINTS,
    PHASES,
    PRINTED,
    Study,
    kalman_path,
    key_points,
    settings_of,
    window_truth,
)
from benchmarks.stride_paper.printed import ALIGNED, AS_STUDIED
from benchmarks.stride_paper.readings import NUMBERS, PRINTED_M, Readings
from benchmarks.stride_paper.steps import METHODS, SAMPLE_BY_SAMPLE, Recording, kalman_way, way
from benchmarks.stride_paper.switches import Switched
from benchmarks.thesis_report.figures import BLUE, GREEN, GREY, ORANGE, TRUTH, Drawing, axes, labelled, legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RED = "#b3261e"
CASE_COLOURS = dict(zip(CASES, (TRUTH, BLUE, GREEN, ORANGE), strict=True))
FIGURES = {"clean": "5", "noise": "6", "drift": "7", "noise and drift": "8"}
MISLED = 6
"""A phase at which a window full of acceleration looks stable."""


def drawings(
    study: Study, switched: Sequence[Switched], readings: Readings, recordings: Sequence[Recording]
) -> Iterator[Drawing]:
    """All figures but those of the whole capture.

    Args:
        study: Errors on the simulated walk.
        switched: The paper's choices, one at a time.
        readings: All readings of the text.
        recordings: Steps; the measured ones are drawn.
    """
    yield _signals()
    for case, number in FIGURES.items():
        yield _positions(case, number)
    yield _sweep(study)
    yield _stability()
    yield _effects(switched)
    yield _cloud(readings)
    for number, kind in zip(("9", "10"), printed.STEPS_M, strict=True):
        shown = [one for one in recordings if one.kind == kind and one.measured]
        if shown:
            yield _steps(number, kind, shown)


def _signals() -> Drawing:
    figure, panels = axes(1, 2, height=2.6)
    walk = cubic_steps()
    for axis, colour, name in ((0, BLUE, "x"), (1, GREY, "y"), (2, ORANGE, "z")):
        panels[0].plot(walk.time_s, walk.position_m[:, axis], color=colour, lw=1.4, label=name)
        panels[1].plot(walk.time_s, walk.specific_force_mps2[:, axis], color=colour, lw=1.2, label=name)
    labelled(panels[0], "time (s)", "position (m)")
    labelled(panels[1], "time (s)", "specific force (m/s²)")
    legend(panels[0])
    return Drawing(
        "3",
        "Simulated walk",
        figure,
        "Figures 3 and 4 of the paper; cubic courses that begin and end at rest.",
    )


def _positions(case: str, number: str) -> Drawing:
    figure, (panel,) = axes(1, 1, height=2.8)
    walk = cubic_steps(case)
    panel.plot(walk.time_s, walk.position_m[:, 0], color=TRUTH, lw=2.2, label="true")
    panel.plot(walk.time_s, kalman_path(walk), color="#6fb1ea", lw=1.1, label="Kalman filter")
    for method, first, colour, name in (
        (PRINTED, AS_STUDIED, RED, "as printed, the paper's windows"),
        (PRINTED, ALIGNED, ORANGE, "as printed, aligned"),
        (KEY_POINTS, ALIGNED, GREEN, "ours, aligned"),
    ):
        settings = settings_of(method, case, first)
        found = key_points(walk, settings)
        panel.plot(found.time_s, found.position_m[:, 0], "o-", ms=2.5, color=colour, lw=1.0, label=name)
    found_s = walk.time_s[-1]
    panel.plot(
        [found_s], [printed.LAST_POSITION_M[case]], "D", ms=5, color="#7a3db8", label="paper's last value"
    )
    settings = settings_of(PRINTED, case, ALIGNED)
    panel.plot(key_points(walk, settings).time_s, window_truth(walk, settings), ".", ms=2, color=TRUTH)
    labelled(panel, "time (s)", "x (m)")
    legend(panel, columns=3)
    note = "Dots: the truth averaged over windows. The diamond is the data tip of the paper's figure."
    return Drawing(number, f"Position, {case}", figure, note)


def _sweep(study: Study) -> Drawing:
    figure, panels = axes(1, 2, height=3.2)
    papers = (printed.FINAL_M, printed.MEAN_M)
    for which, (panel, name) in enumerate(zip(panels, ("final", "mean"), strict=True)):
        for case, colour in CASE_COLOURS.items():
            for method, style in ((PRINTED, "o-"), (KEY_POINTS, "x:")):
                own = [study.typical(method, case, phase)[which] for phase in PHASES]
                panel.semilogy(
                    PHASES, own, style, ms=3, color=colour, lw=1.0, label=case if style == "o-" else None
                )
            panel.plot([9.4, 10.2], [papers[which][case]] * 2, "-", color=colour, lw=2.0)
        kalman = [
            max(study.largest(KALMAN, case, k)[which] for case in study.cases) for k in range(len(DELAYS_S))
        ]
        panel.plot(PHASES, kalman, color=GREY, lw=3.0, label="Kalman, worst case")
        labelled(panel, "first sample of the first window", f"{name} error (m)")
        panel.set_xticks(PHASES)
    legend(panels[1], columns=3)
    note = (
        "Median of the draws: as printed (lines), ours (dotted). Bars at the right: the paper. The Kalman filter "
        "has no windows; its walk is delayed against the samples by 21 ms per step."
    )
    return Drawing("own", "Phase of the windows", figure, note)


def _stability() -> Drawing:
    figure, panels = axes(1, 2, height=2.6)
    walk = cubic_steps()
    for panel, first, name in zip(
        panels, (ALIGNED, MISLED), ("aligned", f"begun at sample {MISLED}"), strict=True
    ):
        found = key_points(walk, printed.simulated("clean", first))
        colours = [BLUE if still else "#c9ced3" for still in found.still]
        panel.set_axisbelow(True)
        panel.bar(found.time_s, found.stability, width=0.17, color=colours)
        panel.axhline(1.0, color=RED, lw=1.0)
        panel.plot(walk.time_s, walk.specific_force_mps2[:, 0] / 3.0, color=TRUTH, lw=0.8)
        panel.set_title(f"windows {name}", fontsize=9, loc="left")
        panel.set_ylim(-2.3, 3.6)
        labelled(panel, "time (s)", "S; black: a_x / 3 (m/s²)")
    note = (
        "Blue: key points, red: E_s. When the first window of a step holds only part of it, its mean can equal the "
        "next window's. S is then small at full acceleration, and that acceleration is taken for gravity."
    )
    return Drawing("own", "Stability of windows", figure, note)


def _effects(switched: Sequence[Switched]) -> Drawing:
    figure, (panel,) = axes(1, 1, height=3.0)
    shown = [one for one in switched if one.phase == ALIGNED]
    for k, one in enumerate(shown):
        panel.plot(one.change_m, np.full(len(one.change_m), -k), "o", ms=4, color=BLUE, alpha=0.6)
        panel.plot([one.change_m.min(), one.change_m.max()], [-k, -k], color=BLUE, lw=1.0)
    for side in (-1.0, 1.0):
        panel.axvline(side * (printed.FINAL_M["drift"] - printed.FINAL_M["clean"]), color=RED, ls=":", lw=1.0)
    panel.set_yticks([-k for k in range(len(shown))], [one.name for one in shown])
    labelled(panel, "change of the final position by drift (m)", "")
    note = (
        "One dot per direction of the gyroscope's constant, aligned windows. Red: size of the paper's change."
    )
    return Drawing("own", "Effect of drift", figure, note)


def _cloud(readings: Readings) -> Drawing:
    figure, panels = axes(1, 2, height=3.0)
    values = np.maximum(readings.values_m, 1e-3)
    for panel, (a, b) in zip(panels, ((0, 1), (0, 2)), strict=True):
        panel.loglog(values[:, a], values[:, b], ".", ms=2, color=BLUE, alpha=0.3, rasterized=True)
        panel.plot([PRINTED_M[a]], [PRINTED_M[b]], "D", ms=6, color=RED)
        labelled(panel, f"{NUMBERS[a]} (m)", f"{NUMBERS[b]} (m)")
    note = f"One dot per reading ({len(values)}); red: the paper."
    return Drawing("own", "Readings of the text", figure, note)


def _steps(number: str, kind: str, shown: Sequence[Recording]) -> Drawing:
    figure, panels = axes(1, len(shown), height=2.8)
    for panel, one in zip(panels, shown, strict=True):
        panel.plot(one.course_s, one.course_m, color=TRUTH, lw=2.0, label="cameras, heel")
        panel.plot(*kalman_way(one.readings), color="#6fb1ea", lw=1.2, label="Kalman filter")
        for name, colour, settings in (
            ("as printed", RED, replace(METHODS["as printed"], first=ALIGNED)),
            ("ours, windows of 5, by sample", GREEN, SAMPLE_BY_SAMPLE),
        ):
            seconds, metres = way(one.readings, settings)
            panel.plot(seconds, metres, color=colour, lw=1.1, label=name)
        panel.set_title(one.name, fontsize=9, loc="left")
        labelled(panel, "time (s)", "horizontal way (m)")
    _legend_below(panels[0])
    note = "Stand-ins for the paper's recording: measured first steps of a healthy person."
    return Drawing(number, f"Measured, {kind}", figure, note)


def measured_drawing(compared: Sequence[Compared]) -> Drawing:
    """Strides of the whole capture beside the cameras', and how long feet rest in walking.

    Args:
        compared: Strides by every method, the smoother and the filter first.
    """
    figure, (left, right) = axes(1, 2, height=3.2)
    best, plain = compared[0], compared[1]
    left.plot([0.2, 1.6], [0.2, 1.6], color=TRUTH, lw=0.8)
    left.errorbar(
        best.reference_m, best.lengths_m, best.sd_m, fmt="o", ms=3, color=BLUE, lw=0.7, label=best.name
    )
    left.plot(plain.reference_m, plain.lengths_m, "x", ms=4, color=ORANGE, label=plain.name)
    legend(left)
    labelled(left, "cameras (m)", "sensor (m)")
    right.set_axisbelow(True)
    right.hist(best.rests_s[best.rests_s < 0.6], bins=30, range=(0.0, 0.6), color=BLUE)
    window_s = printed.WINDOW / printed.RATE_HZ
    right.axvline(window_s, color=RED, lw=1.2)
    right.text(window_s + 0.01, 0.94 * right.get_ylim()[1], "one window", fontsize=8, color=RED)
    labelled(right, "length of a rest in walking (s)", "rests")
    note = (
        "A window that lies wholly inside such a rest is often not to be had: the paper's method, made for single "
        "steps with pauses, misses strides in ordinary walking."
    )
    return Drawing("own", "Strides measured by cameras", figure, note)


def _legend_below(panel: Axes) -> None:
    panel.legend(fontsize=7, frameon=False, loc="upper left")
