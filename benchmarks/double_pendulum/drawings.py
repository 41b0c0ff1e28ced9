"""The thesis's figures 3.7–3.23 drawn again from our own runs: the same quantities on the same axes.

Black is the truth, blue FCDI, orange FD, as in the thesis. Single trials are those of one seed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.double_pendulum.consistency import FRAMES, READING_DOF, STATE_DOF, Consistency
from benchmarks.double_pendulum.kinematic import KinematicMethod
from benchmarks.double_pendulum.motions import RATE_HZ, PendulumNoise
from benchmarks.double_pendulum.studies import HIGH_RESIDUAL, WRONG, with_model
from benchmarks.double_pendulum.sweeps import Sweep, Sweeps
from benchmarks.double_pendulum.thesis import FCDI, FD, FDMC, KINEMATIC_ACCELERATION, STUDY, STUDY_RECIPE
from benchmarks.double_pendulum.trials import Estimate, Method, Recipe, Trial
from benchmarks.thesis_report.figures import (
    BLUE,
    GREEN,
    ORANGE,
    SHADE,
    TRUTH,
    Drawing,
    axes,
    labelled,
    legend,
    lowered,
)
from mbkf.conventions import Array
from mbkf.synthesis.cameras import skin_artefact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SEED = 0
GAPS_S = ((0.85, 1.15), (1.85, 2.15))

COLOURS = {"FCDI": BLUE, "FD": ORANGE, "FDMC": GREEN}

_BANDS = {"NEES": (STATE_DOF, 11.33, 12.69), "NIS": (READING_DOF, 10.36, 11.66)}


def drawings(sweeps: Sweeps, consistency: dict[str, list[Consistency]]) -> Iterator[Drawing]:
    """All figures."""
    trial = STUDY_RECIPE.trial(SEED)
    yield from _motion_drawings(trial)
    yield from _sweep_drawings(sweeps)
    yield from _estimate_drawings(trial)
    yield from _study_drawings(trial)
    yield _consistency_drawing(consistency)


# What moves, and what is read.


def _motion_drawings(trial: Trial) -> Iterator[Drawing]:
    motion, t = trial.motion, trial.motion.times_s
    noise, rng = PendulumNoise(), np.random.default_rng(SEED)
    figure, (above, below) = axes(2, height=2.0)
    above.plot(t, 1e3 * noise.camera_m * rng.normal(size=len(t)), color=BLUE, lw=0.8)
    slid = skin_artefact((len(t), 1), RATE_HZ, noise.artefact_m, noise.cutoff_hz, rng)
    below.plot(t, 1e3 * slid, color=ORANGE)
    labelled(above, "", "cameras (mm)")
    labelled(below, "time (s)", "skin (mm)")
    yield Drawing("3.7", "Noise of the virtual markers: cameras above, skin below", figure)

    for number, values, quantity in (("3.8", motion.q, "angle (rad)"), ("3.9", motion.v, "velocity (rad/s)")):
        figure, (one,) = axes()
        dot = "'" if number == "3.9" else ""
        for column, style in ((2, "-"), (3, "--")):
            one.plot(t, values[:, column], style, color=TRUTH, label=lowered(f"θ{dot}_{column - 1}"))
        labelled(one, "time (s)", quantity)
        legend(one)
        title = "Angles" if number == "3.8" else "Velocities"
        yield Drawing(number, f"{title} of θ_1 and θ_2 of the motion `sin`", figure)

    figure, (one,) = axes()
    for column, name, colour in ((4, "x", BLUE), (5, "y", ORANGE)):
        one.plot(t, trial.read.markers_m[:, column], color=colour, label=f"{name} of marker 3")
    labelled(one, "time (s)", "position (m)")
    legend(one)
    yield Drawing("3.10", "Marker 3 as the cameras see it, artefact included", figure)

    figure, four = axes(2, 2, height=2.1)
    for one, column, name in zip(
        four, (1, 2, 3, 0), ("F_x (N)", "F_y (N)", "T_2 (N m)", "τ_1 (N m)"), strict=True
    ):
        one.plot(t, motion.efforts[:, column], color=TRUTH)
        labelled(one, "time (s)", name)
    yield Drawing("3.11", "Efforts of the motion: F_x, F_y, T_2 and τ_1", figure)


# Errors over covariances.


def _sweep_drawings(sweeps: Sweeps) -> Iterator[Drawing]:
    curve = partial(_curves, columns=(("torque", "RMS of τ_1 (N m)"),))
    yield Drawing(
        "3.12",
        "FCDI: error of the torque over the covariance of the acceleration",
        curve(sweeps.kinematic, "σ_a (rad/s²)"),
        "The thesis draws an asymptote; over many seeds the curve is a U.",
    )
    yield Drawing(
        "3.13",
        "FD: error of the torque over the covariance of the efforts",
        curve(sweeps.dynamic, "σ_P (N m/√s)"),
        "The thesis draws an asymptote here, too.",
    )
    for number, key, name, unit in (
        ("3.14", "position", "positions", "RMS of z (m, rad)"),
        ("3.15", "velocity", "velocities", "RMS of z' (m/s, rad/s)"),
    ):
        figure = _curves(sweeps.dynamic, "σ_P (N m/√s)", ((key, unit),))
        yield Drawing(number, f"FD: error of the {name} over the covariance of the efforts", figure)


def _curves(family: dict[str, Sweep], label: str, columns: Sequence[tuple[str, str]]) -> Figure:
    figure, made = axes(len(columns))
    for one, (key, unit) in zip(made, columns, strict=True):
        for (motion, sweep), colour in zip(family.items(), (ORANGE, BLUE), strict=True):
            least, middle, most = sweep.quantiles(key, 0.1, 0.5, 0.9)
            one.semilogx(sweep.values, middle, "o-", ms=3, color=colour, label=motion)
            one.fill_between(sweep.values, least, most, color=colour, alpha=0.15, lw=0)
            one.set_xticks(sweep.values, [f"{value:g}" for value in sweep.values], fontsize=8)
            one.set_xticks([], minor=True)
        _cropped(one, np.concatenate([sweep.quantiles(key, 0.5)[0] for sweep in family.values()]))
        labelled(one, label, unit)
        legend(one)
    return figure


def _cropped(one: Axes, values: Array) -> None:
    """Keeps a diverging end from flattening the rest."""
    finite = values[np.isfinite(values)]
    one.set_ylim(0.0, min(1.3 * finite.max(), 4.0 * float(np.median(finite))))


# Estimates.


def _estimate_drawings(trial: Trial) -> Iterator[Drawing]:
    both = _followed(trial, {"FCDI": FCDI, "FD": FD})
    figure = _against(trial, both, "q", (("x_0 (m)", 0), ("y_0 (m)", 1), ("θ_1 (rad)", 2), ("θ_2 (rad)", 3)))
    yield Drawing("3.16", "Positions estimated by FCDI and FD", figure)
    speeds = (("x'_0 (m/s)", 0), ("y'_0 (m/s)", 1), ("θ'_1 (rad/s)", 2), ("θ'_2 (rad/s)", 3))
    yield Drawing("3.17", "Velocities estimated by FCDI and FD", _against(trial, both, "v", speeds))
    yield Drawing("3.18", "Torque τ_1 estimated by FCDI and FD", _torques(trial, both))
    three = both | _followed(trial, {"FDMC": FDMC})
    yield Drawing("3.19", "Torque τ_1 estimated by FD and FDMC", _torques(trial, three))


def _study_drawings(trial: Trial) -> Iterator[Drawing]:
    for number, residual, words in (("3.20", 1e-3, "tightly"), ("3.21", HIGH_RESIDUAL, "loosely")):
        methods: dict[str, Method] = {
            "FCDI": KinematicMethod(WRONG, KINEMATIC_ACCELERATION),
            "FD": with_model(FD, WRONG, residual),
            "FDMC": with_model(FDMC, WRONG, residual),
        }
        title = f"Torque τ_1 with wrong masses, residual {words} restricted (σ = {residual:g})"
        yield Drawing(number, title, _torques(trial, _followed(trial, methods)))
    lost = Recipe("sin", STUDY, PendulumNoise(), 1, GAPS_S).trial(SEED)
    both = _followed(lost, {"FCDI": FCDI, "FD": FD})
    figure, (angle, speed) = axes(2, height=2.3)
    for one, name, unit in ((angle, "q", "θ_1 (rad)"), (speed, "v", "θ'_1 (rad/s)")):
        _draw(one, lost, both, name, 2)
        labelled(one, "time (s)", unit)
    legend(angle)
    note = (
        "Grey: both markers of bar 1 are lost. Two gaps are drawn; the study's ratios are of the first one."
    )
    yield Drawing("3.22", "θ_1 and θ̇_1 while markers are lost", figure, note)
    yield Drawing("3.23", "Torque τ_1 while markers are lost", _torques(lost, both), note)


def _followed(trial: Trial, methods: dict[str, Method]) -> dict[str, Estimate]:
    return {name: method.run(trial) for name, method in methods.items()}


def _against(
    trial: Trial, found: dict[str, Estimate], name: str, columns: Sequence[tuple[str, int]]
) -> Figure:
    figure, made = axes(2, 2, height=2.1)
    for one, (unit, column) in zip(made, columns, strict=True):
        _draw(one, trial, found, name, column)
        labelled(one, "time (s)", unit)
    legend(made[1])
    return figure


def _torques(trial: Trial, found: dict[str, Estimate]) -> Figure:
    figure, (one,) = axes(height=3.0)
    _draw(one, trial, found, "efforts", 0)
    truth = trial.motion.efforts[:, 0]
    one.set_ylim(1.6 * truth.min(), 1.6 * truth.max())
    labelled(one, "time (s)", "τ_1 (N m)")
    legend(one)
    return figure


def _draw(one: Axes, trial: Trial, found: dict[str, Estimate], name: str, column: int) -> None:
    t = trial.motion.times_s
    edges = np.diff(np.concatenate([[0], trial.hidden.astype(int), [0]]))
    for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        one.axvspan(t[begin], t[end - 1], color=SHADE, lw=0)
    for label, estimate in found.items():
        one.plot(t, getattr(estimate, name)[:, column], color=COLOURS[label], lw=1.1, label=label)
    one.plot(t, getattr(trial.motion, name)[:, column], color=TRUTH, lw=1.0, label="truth")


# Consistency.


def _consistency_drawing(consistency: dict[str, list[Consistency]]) -> Drawing:
    figure, made = axes(2, height=2.3)
    t = np.arange(1, FRAMES + 1) / RATE_HZ
    for one, (key, (dof, low, high)) in zip(made, _BANDS.items(), strict=True):
        one.axhspan(low, high, color=SHADE, lw=0)
        for (name, trials), colour in zip(consistency.items(), (TRUTH, ORANGE, GREEN), strict=False):
            values = np.mean([getattr(trial, key.lower()) for trial in trials], axis=0)
            one.plot(t, np.where(np.isfinite(values), values, np.nan), color=colour, lw=1.1, label=name)
        one.set_ylim(0.5 * dof, 2.5 * dof)
        labelled(one, "time (s)", f"mean {key}")
    legend(made[0])
    note = "Grey: 95 % band of a mean over 200 trials. Without exact steps the filter grows sure of wrong numbers."
    return Drawing("own", "Consistency at matched low noise", figure, note)
