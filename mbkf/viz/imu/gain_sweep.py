"""A search of Madgwick's gains as a picture: the error over β for each ζ, and one component of some of the courses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mbkf.conventions import Array
from mbkf.imu.orientation import Orientation
from mbkf.imu.orientation_difference import orientation_difference
from mbkf.imu.tuning import SearchedGains
from mbkf.viz.imu.figure_file import write_figure

SHOWN_S = 10.0
"""Length of the courses that are drawn."""

REFERENCE = "#111111"
COLOURS = ("#1f6fb4", "#e06c10", "#2a9150", "#8a4fb0", "#b3261e", "#9aa0a6")


def write_sweep(
    found: SearchedGains, reference: Array, courses: Sequence[tuple[str, Orientation]], path: str | Path
) -> None:
    """Draws a search into a PNG, SVG or PDF file.

    Args:
        found: The gains that were tried.
        reference: (T, 4) the orientations that they were to follow, NaN where unknown.
        courses: Label and course of the gains to show, at the same samples; the best one first.
        path: The file; its suffix chooses the format.

    Raises:
        OSError: The file cannot be written.
    """
    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_errors(left, found)
    draw_courses(right, reference, courses)
    for one in (left, right):
        one.grid(color="#e4e6e8", linewidth=0.7)
        one.spines[["top", "right"]].set_visible(False)
    write_figure(figure, path, dpi=110)


def draw_errors(axes: Axes, found: SearchedGains) -> None:
    """Draws the error over β, a line for each ζ, and marks the best pair.

    Args:
        axes: The axes.
        found: The gains that were tried.
    """
    zetas = sorted({zeta for _, zeta, _ in found.trials})
    shown = [zetas[k] for k in sorted({round(x) for x in np.linspace(0, len(zetas) - 1, len(COLOURS))})]
    for zeta, colour in zip(shown, COLOURS, strict=False):
        own = sorted((beta, np.degrees(error)) for beta, of, error in found.trials if of == zeta)
        axes.plot(*zip(*own, strict=True), "o-", ms=3, lw=1.0, color=colour, label=f"ζ {zeta:.3g}")
    best = found.settings
    axes.plot([best.beta], [np.degrees(found.error.total)], "*", ms=13, color=REFERENCE)
    axes.set_title(f"least at β {best.beta:.3g}, ζ {best.zeta:.3g}", fontsize=9, loc="left")
    betas = [beta for beta, _, _ in found.trials if beta > 0.0]
    if betas and max(betas) > 20.0 * min(betas):
        axes.set_xscale("log")
    axes.set_xlabel("β (rad/s)")
    axes.set_ylabel("RMS difference (deg)")
    axes.legend(fontsize=8)


def draw_courses(axes: Axes, reference: Array, courses: Sequence[tuple[str, Orientation]]) -> None:
    """Draws q_w of the reference and of some gains over the first ten seconds.

    Args:
        axes: The axes.
        reference: (T, 4) the orientations that the gains were to follow.
        courses: Label and course of each of the gains.
    """
    time_s = courses[0][1].time_s - courses[0][1].time_s[0]
    part = time_s <= SHOWN_S
    axes.plot(time_s[part], reference[part, 3], color=REFERENCE, lw=1.6, label="reference")
    for (label, course), colour in zip(courses, COLOURS, strict=False):
        near = orientation_difference(reference, course.quaternion).quaternion
        axes.plot(time_s[part], near[part, 3], color=colour, lw=0.9, label=label)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("qw")
    axes.legend(fontsize=8)
