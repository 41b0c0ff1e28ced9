"""Draws the picture of the README: a synthetic walk, reconstructed, beside its known truth.

Run ``python -m benchmarks.picture FILE.png``.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.cli.main import main as mbkf_command
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import read_subject
from mbkf.io.truth import Truth, read_truth
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.sensors.contact.soles import sole_points
from mbkf.trial.reconstruct import reconstruct

MEASURED, BODY, FORCE, TRUTH = "#7a869a", "#1f3a5f", "#c8553d", "#111111"
CHAINS = (
    ("pelvis", "neck", "head"),
    ("pelvis", "right_thigh", "right_shank", "right_foot", "right_toes"),
    ("pelvis", "left_thigh", "left_shank", "left_foot", "left_toes"),
    ("neck", "right_upper_arm", "right_forearm", "right_hand"),
    ("neck", "left_upper_arm", "left_forearm", "left_hand"),
)
NEWTON_PER_METRE = 1600.0
POSES = 7


def draw(folder: Path, target: Path) -> None:
    """Reconstructs the synthetic capture in a folder and writes the picture."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    capture = read_capture(folder / "trial.c3d")
    truth = read_truth(folder / "truth.h5")
    result = reconstruct(capture, read_subject(folder / "subject.toml"))
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure = plt.figure(figsize=(11, 6.2), dpi=130)
    grid = figure.add_gridspec(2, 3, height_ratios=(1.45, 1.0), hspace=0.18, wspace=0.28)
    _walker(figure.add_subplot(grid[0, :]), result)
    model = HumanModel.of(result.subject)
    clinical = ClinicalAngles(model)
    angles = clinical.angles(truth.q)
    moments = clinical.moments(truth.q, truth.tau, angles)
    knee, ankle = clinical.names.index("knee_angle_r"), clinical.names.index("ankle_angle_r")
    times = result.times_s
    _curve(
        figure.add_subplot(grid[1, 0]),
        times,
        np.rad2deg(result.angle("knee_angle_r")),
        np.rad2deg(result.angle_sd("knee_angle_r")),
        np.rad2deg(angles[:, knee]),
        "right knee flexion, °",
    )
    _curve(
        figure.add_subplot(grid[1, 1]),
        times,
        result.moment("ankle_angle_r"),
        result.moment_sd("ankle_angle_r"),
        moments[:, ankle],
        "right ankle torque, N m",
    )
    _reactions(figure.add_subplot(grid[1, 2]), result, truth)
    figure.savefig(target, bbox_inches="tight", facecolor="white")
    plt.close(figure)


def _walker(axes: Any, result: Reconstruction) -> None:
    """Stick figures from the side with measured markers and reaction arrows."""
    model = HumanModel.of(result.subject)
    frames = np.linspace(0.06, 0.94, POSES) * (result.frames - 1)
    for frame in frames.astype(int):
        _, origins = model.placements(result.q[frame])
        soles = sole_points(model, result.q[frame][None])[0]
        for chain in CHAINS:
            points = np.array([origins[model.joint(name).joint_id] for name in chain])
            side = 0.45 if "left" in chain[1] else 1.0
            axes.plot(points[:, 0], points[:, 2], color=BODY, alpha=side, lw=2.2, solid_capstyle="round")
        head = origins[model.joint("head").joint_id]
        axes.add_patch(_circle(head[0] + 0.02, head[2] + 0.09, 0.1))
        for side, sole in enumerate(soles):
            axes.plot(sole[:, 0], sole[:, 2], color=BODY, alpha=(1.0, 0.45)[side], lw=2.2)
        seen = result.measured_m[frame]
        axes.plot(seen[:, 0], seen[:, 2], "o", color=MEASURED, ms=2.2, alpha=0.9)
        for side in range(2):
            point, force = result.foot_cop_m[frame, side], result.foot_wrench[frame, side, :3]
            if np.isfinite(point).all():
                axes.annotate(
                    "",
                    (point[0] + force[0] / NEWTON_PER_METRE, force[2] / NEWTON_PER_METRE),
                    (point[0], 0.0),
                    arrowprops={"arrowstyle": "-|>", "color": FORCE, "lw": 1.6},
                )
    axes.axhline(0.0, color="#cccccc", lw=1)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("measured markers, reconstructed body, ground reactions", fontsize=10, color="#444444")


def _circle(x: float, z: float, radius: float) -> Any:
    from matplotlib.patches import Circle

    return Circle((x, z), radius, facecolor="white", edgecolor=BODY, lw=2.2, zorder=3)


def _curve(axes: Any, times: Array, value: Array, sd: Array, truth: Array, title: str) -> None:
    axes.fill_between(times, value - 2 * sd, value + 2 * sd, color=FORCE, alpha=0.18, lw=0, label="± 2 sd")
    axes.plot(times, value, color=FORCE, lw=1.3, label="mbkf")
    axes.plot(times, truth, color=TRUTH, lw=1.0, ls="--", label="truth")
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_xlabel("time, s")
    axes.margins(y=0.22)
    axes.legend(frameon=False, fontsize=7, loc="upper center", ncols=3)


def _reactions(axes: Any, result: Reconstruction, truth: Truth) -> None:
    for side, (label, shade) in enumerate((("right", 1.0), ("left", 0.5))):
        axes.plot(
            result.times_s, result.foot_wrench[:, side, 2], color=FORCE, alpha=shade, lw=1.3, label=label
        )
        axes.plot(truth.times_s, truth.foot_wrench[:, side, 2], color=TRUTH, lw=0.8, ls="--")
    axes.set_title("vertical ground reaction, N", fontsize=9, loc="left")
    axes.set_xlabel("time, s")
    axes.plot([], [], color=TRUTH, lw=0.8, ls="--", label="truth")
    axes.margins(y=0.22)
    axes.legend(frameon=False, fontsize=7, loc="upper center", ncols=3)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        code = mbkf_command(["synth", "--motion", "walk", "--seed", "1", "--out", scratch])
        if code == 0:
            draw(Path(scratch), Path(sys.argv[1]))
    sys.exit(code)
