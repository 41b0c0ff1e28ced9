"""A picture of the feet's paths: seen from above, height over time with the rests marked, and the strides' lengths."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mbkf.numerics.runs import runs
from mbkf.trial.inertial.stride import FootResult, StrideMeasurement
from mbkf.viz.imu.figure_file import write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#1f6fb4", "#e06c10")
MANY_COLOURS = (*COLOURS, "#2a9150", "#7a4fb0")
_WIDTH_IN = 11.0


def foot_path_figure(measured: StrideMeasurement) -> Figure:
    """The figure: a bar on the lower edge and a dot on the path mark each rest."""
    from matplotlib.figure import Figure

    feet = measured.feet
    figure = Figure(figsize=(_WIDTH_IN, 3.2 + 1.7 * len(feet) + 2.4), dpi=130, layout="constrained")
    ratios = [1.5, *(0.9 for _ in feet), 1.1]
    grid = figure.add_gridspec(len(ratios), 1, height_ratios=ratios)
    path = figure.add_subplot(grid[0])
    heights = [figure.add_subplot(grid[1 + n]) for n in range(len(feet))]
    lengths = figure.add_subplot(grid[-1], sharex=heights[0])
    for one in heights[1:]:
        one.sharex(heights[0])
    for n, (foot, height) in enumerate(zip(feet, heights, strict=True)):
        colour = MANY_COLOURS[n % len(MANY_COLOURS)]
        _draw_path(path, foot, colour)
        _draw_height(height, foot, colour)
        _draw_lengths(lengths, foot, colour)
    path.set(xlabel="along the first stride (m)", ylabel="to the left (m)")
    path.set_title("Path from above; dots are rests on the ground", loc="left", fontsize=10)
    path.set_aspect("equal", adjustable="datalim")
    path.legend(frameon=False, fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4)
    lengths.set(xlabel="time (s)", ylabel="stride length (m)", ylim=(0.0, None))
    lengths.set_title(
        "Strides, each from rest to rest; bars are ± 1 standard deviation", loc="left", fontsize=10
    )
    for one in (path, *heights, lengths):
        one.spines[["top", "right"]].set_visible(False)
        one.grid(color="#e4e6e8", linewidth=0.7)
        one.set_axisbelow(True)
        one.tick_params(labelsize=8)
    return figure


def write_foot_path(measured: StrideMeasurement, path: str | Path) -> None:
    """Draws the figure into a file, of the kind its suffix names (.png, .svg, .pdf)."""
    write_figure(foot_path_figure(measured), path)


def _draw_path(axes: Axes, foot: FootResult, colour: str) -> None:
    axes.plot(foot.position_m[:, 0], foot.position_m[:, 1], color=colour, lw=1.0, label=foot.name)
    middles = [(start + stop - 1) // 2 for start, stop in runs(foot.still)]
    axes.plot(*foot.position_m[middles, :2].T, "o", ms=3.5, color=colour, mec="white", mew=0.5)


def _draw_height(axes: Axes, foot: FootResult, colour: str) -> None:
    height = 100.0 * foot.position_m[:, 2]
    axes.plot(foot.time_s, height, color=colour, lw=1.0)
    step = float(np.median(np.diff(foot.time_s)))
    for start, stop in runs(foot.still):
        axes.axvspan(
            foot.time_s[start] - 0.5 * step,
            foot.time_s[stop - 1] + 0.5 * step,
            color=colour,
            alpha=0.18,
            lw=0,
        )
    axes.set_ylabel("height (cm)")
    axes.set_title(f"{foot.name}: height of the sensor; shaded while the foot rests", loc="left", fontsize=10)
    axes.label_outer()


def _draw_lengths(axes: Axes, foot: FootResult, colour: str) -> None:
    for stride in foot.strides:
        middle = 0.5 * (stride.start_s + stride.end_s)
        half = 0.5 * (stride.end_s - stride.start_s)
        axes.plot([middle - half, middle + half], [stride.length_m] * 2, color=colour, lw=1.6)
        if np.isfinite(stride.length_sd_m):
            axes.errorbar(middle, stride.length_m, stride.length_sd_m, color=colour, lw=0.8, capsize=2)
