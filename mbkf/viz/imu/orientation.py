"""Two orientations of one sensor, of filters or of a file, and their difference, as quaternions and as angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mbkf.conventions import Array
from mbkf.imu.orientation import Orientation
from mbkf.imu.orientation_difference import orientation_difference
from mbkf.viz.imu.figure_file import write_figure

FIRST, SECOND, DIFFERENCE = "#1f6fb4", "#e06c10", "#444444"
_DEGREES = 180.0 / np.pi
_ANGLES = ("roll", "pitch", "yaw")


def write_comparison(first: Orientation, second: Orientation, path: str | Path) -> None:
    """Draws two orientations over time, and their difference, into a PNG or SVG file.

    Left the quaternion's components, right the unwrapped Euler angles; the upper rows hold both, the lowest
    row second minus first.

    Args:
        first: Orientations of a filter.
        second: Those of another filter, or of a file, at the same times.
        path: The file; its suffix chooses the format.

    Raises:
        OSError: The file cannot be written.
    """
    figure = Figure(figsize=(11.0, 10.0), layout="constrained")
    axes = figure.subplots(5, 2, sharex=True)
    apart = orientation_difference(first.quaternion, second.quaternion)
    q1, q2 = first.quaternion, apart.quaternion
    for row, name in enumerate("wxyz"):
        k = "xyzw".index(name)
        _both(axes[row, 0], first, second, q1[:, k], q2[:, k], f"q{name}")
        axes[4, 0].plot(first.time_s, apart.components[:, k], label=f"q{name}", linewidth=0.9)
    e1, between = _DEGREES * first.euler_rad, _DEGREES * apart.euler_rad
    for row, name in enumerate(_ANGLES):
        _both(axes[row, 1], first, second, e1[:, row], e1[:, row] + between[:, row], f"{name} (deg)")
        axes[4, 1].plot(first.time_s, between[:, row], label=name, linewidth=0.9)
    axes[3, 1].plot(first.time_s, _DEGREES * apart.angle_rad, color=DIFFERENCE, linewidth=0.9)
    axes[3, 1].set_ylabel("angle between (deg)")
    for column, unit in enumerate(("", " (deg)")):
        axes[4, column].set_ylabel(f"{second.method} − {first.method}{unit}")
        axes[4, column].set_xlabel("time (s)")
        axes[4, column].legend(fontsize=8, ncols=4)
    axes[0, 0].legend(fontsize=8)
    figure.suptitle(f"{first.name}, {first.frame}")
    for one in axes.flat:
        one.grid(color="#e4e6e8", linewidth=0.7)
        one.spines[["top", "right"]].set_visible(False)
    write_figure(figure, path, dpi=110)


def _both(axes: Axes, first: Orientation, second: Orientation, a: Array, b: Array, name: str) -> None:
    axes.plot(first.time_s, a, color=FIRST, linewidth=0.9, label=first.method)
    axes.plot(second.time_s, b, color=SECOND, linewidth=0.9, label=second.method)
    axes.set_ylabel(name)
