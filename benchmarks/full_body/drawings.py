"""The thesis's figures 4.4 to 4.15 drawn again from our own trials, and the errors of all filters at a glance.

Persons and movements are the thesis's: the man of 78 kg for the general movement, the woman of 49.75 kg for squats, the
man of 85 kg for the jump. The truth is black; the thesis had none and drew one filter against the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.dynamic.methods import Mapper
from benchmarks.full_body.filters import CAUSAL, COLOURS, DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME
from benchmarks.full_body.persons import OF_GENERAL, OF_JUMP, OF_SQUAT, PERSONS
from benchmarks.full_body.real import RealScores
from benchmarks.full_body.survey import Survey
from benchmarks.full_body.trials import BESIDE, GENERAL, JUMP, LOST, MOVEMENTS, SQUAT, Trial, make_trials
from benchmarks.thesis_report.figures import SHADE, TRUTH, Drawing, axes, labelled, legend
from mbkf.conventions import SIDES, Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.model.clinical import ClinicalAngles
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES
from mbkf.synthesis.person import body_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DRAWN = (FCDI, FDMC_PER_FRAME, DYNAMIC)
SEED = 0

HIP = (("hip_flexion", "flexion"), ("hip_adduction", "adduction"), ("hip_rotation", "rotation"))
CHAIN = (("hip_flexion", "hip"), ("knee_angle", "knee"), ("ankle_angle", "ankle"))


@dataclass(frozen=True)
class Followed:
    """A trial, its true clinical curves, and what the filters made of it.

    Attributes:
        trial: The trial.
        names: Clinical coordinates.
        angles, rates, moments: (T, A) true curves, rad, rad/s and N m.
        runs: Reconstructions by filter.
    """

    trial: Trial
    names: tuple[str, ...]
    angles: Array
    rates: Array
    moments: Array
    runs: dict[str, Reconstruction]


def follow(key: tuple[str, int]) -> dict[str, Followed]:
    """The trials of a movement and a person, followed by the filters that are drawn.

    Args:
        key: Movement and place of the person.
    """
    return {trial.movement: _followed(trial) for trial in make_trials(*key, SEED)}


def _followed(trial: Trial) -> Followed:
    with np.errstate(all="ignore"):
        return with_truth(trial, {name: CAUSAL[name].run(trial.capture, trial.subject) for name in DRAWN})


def with_truth(trial: Trial, runs: dict[str, Reconstruction]) -> Followed:
    """A trial's reconstructions beside its true clinical curves.

    Args:
        trial: The trial.
        runs: Its reconstructions by filter.
    """
    model, truth = body_of(trial.subject), trial.truth
    clinical = ClinicalAngles(model)
    angles = clinical.angles(truth.q)
    rates = np.einsum("tan,tn->ta", clinical.rate_matrices(truth.q, angles), truth.v)
    moments = clinical.moments(truth.q, truth.tau, angles)
    return Followed(trial, clinical.names, angles, rates, moments, runs)


def thesis_drawings(mapper: Mapper, movements: Sequence[str] = (GENERAL, SQUAT, JUMP)) -> Iterator[Drawing]:
    """The thesis's figures.

    Args:
        mapper: Runs a function on many items, in turn or on several processes.
        movements: Those whose figures are drawn.
    """
    persons = {GENERAL: OF_GENERAL, SQUAT: OF_SQUAT, JUMP: OF_JUMP}
    made: dict[str, Followed] = {}
    for part in mapper(follow, [(movement, persons[movement]) for movement in movements]):
        made.update(part)
    if GENERAL in made:
        yield from _general(made[GENERAL], made[BESIDE])
    if SQUAT in made:
        yield from squat_drawings(made[SQUAT], made[LOST])
    if JUMP in made:
        who = PERSONS[OF_JUMP].label
        figure = _moments(made[JUMP], "r", CHAIN[2:])
        yield Drawing("4.15", f"Jump: torque of the right ankle ({who})", figure)


def _general(followed: Followed, beside: Followed) -> Iterator[Drawing]:
    who = PERSONS[OF_GENERAL].label
    yield Drawing("4.4", f"General movement: angles of the right hip ({who})", _angles(followed, HIP))
    yield Drawing(
        "4.5", "General movement: rates of the right hip's angles", _angles(followed, HIP, rates=True)
    )
    figure = _moments(followed, "l", CHAIN)
    yield Drawing("4.6", "General movement: sagittal torques of the left leg", figure)
    note = "Grey: frames in which a loaded foot stands on no plate; the one it stepped on was taken away."
    yield Drawing("4.7", "General movement: residual force", _residual(beside), note)
    yield Drawing("own", "General movement: vertical reactions", _reactions(beside), note)


def _reactions(followed: Followed) -> Figure:
    figure, made = axes(len(SIDES), height=1.9)
    truth = followed.trial.truth
    for foot, (one, side) in enumerate(zip(made, SIDES, strict=True)):
        _shaded(one, truth.times_s, ~followed.runs[FCDI].measured)
        for name, run in followed.runs.items():
            one.plot(run.times_s, run.foot_wrench[:, foot, 2], color=COLOURS[name], lw=0.9, label=name)
        one.plot(truth.times_s, truth.foot_wrench[:, foot, 2], color=TRUTH, lw=2.0, label="truth", zorder=1)
        labelled(one, "time (s)" if one is made[-1] else "", f"{SIDE_NAMES[side]} foot (N)")
    legend(made[0])
    return figure


def squat_drawings(followed: Followed, lost: Followed) -> Iterator[Drawing]:
    """Figures of a squat and of its twin with lost knee markers."""
    who = PERSONS[OF_SQUAT].label
    knee = (("knee_angle", "flexion"),)
    yield Drawing("4.9", f"Squat: angle of the right knee ({who})", _angles(followed, knee))
    yield Drawing("4.10", "Squat: rate of the right knee's angle", _angles(followed, knee, rates=True))
    yield Drawing("4.11", "Squat: sagittal torques of the right leg", _moments(followed, "r", CHAIN))
    yield Drawing("4.12", "Squat: residual force", _residual(followed))
    note = "Grey: the markers of the right knee are lost."
    figure, (flexion, about) = axes(2, height=2.2)
    _curves(flexion, lost, "angles", "knee_angle_r", np.rad2deg(1.0))
    labelled(flexion, "", "flexion (°)")
    _knee_error(about, lost)
    labelled(about, "time (s)", "error of rotation (°)")
    legend(flexion)
    yield Drawing(
        "4.13", "Squat with the knee markers lost: knee angle, and error of its whole rotation", figure, note
    )
    yield Drawing(
        "4.14", "Squat with the knee markers lost: torques of the right leg", _moments(lost, "r", CHAIN), note
    )


def _angles(followed: Followed, coordinates: Sequence[tuple[str, str]], *, rates: bool = False) -> Figure:
    figure, made = axes(len(coordinates), height=1.9 if len(coordinates) > 1 else 2.8)
    for one, (name, word) in zip(made, coordinates, strict=True):
        _curves(
            one,
            followed,
            "angle_rates" if rates else "angles",
            f"{name}_r",
            1.0 if rates else np.rad2deg(1.0),
        )
        labelled(one, "time (s)" if one is made[-1] else "", f"{word} ({'rad/s' if rates else '°'})")
    legend(made[0])
    return figure


def _moments(followed: Followed, side: str, coordinates: Sequence[tuple[str, str]]) -> Figure:
    figure, made = axes(len(coordinates), height=1.9 if len(coordinates) > 1 else 2.8)
    for one, (name, word) in zip(made, coordinates, strict=True):
        _curves(one, followed, "moments", f"{name}_{side}", 1.0)
        labelled(one, "time (s)" if one is made[-1] else "", f"{word} (N m)")
    legend(made[0])
    return figure


def _curves(one: Axes, followed: Followed, curve: str, coordinate: str, factor: float) -> None:
    times, column = followed.trial.truth.times_s, followed.names.index(coordinate)
    truth = {"angles": followed.angles, "angle_rates": followed.rates, "moments": followed.moments}[curve]
    _shaded(
        one, times, followed.trial.stretch if followed.trial.movement == LOST else np.zeros(len(times), bool)
    )
    for name, run in followed.runs.items():
        own = run.coordinate_names.index(coordinate)
        one.plot(times, factor * getattr(run, curve)[:, own], color=COLOURS[name], lw=0.9, label=name)
    true = factor * truth[:, column]
    one.plot(times, true, color=TRUTH, lw=2.0, label="truth", zorder=1)
    spread = np.ptp(true)
    one.set_ylim(true.min() - 0.6 * spread, true.max() + 0.6 * spread)


def _knee_error(one: Axes, followed: Followed) -> None:
    model, truth = body_of(followed.trial.subject), followed.trial.truth
    part = model.joint("right_shank").v
    _shaded(one, truth.times_s, followed.trial.stretch)
    for name, run in followed.runs.items():
        error = [
            np.linalg.norm(model.difference(q, true)[part]) for q, true in zip(run.q, truth.q, strict=True)
        ]
        one.plot(truth.times_s, np.rad2deg(error), color=COLOURS[name], lw=0.9)


def _residual(followed: Followed) -> Figure:
    figure, (one,) = axes(height=2.8)
    runs = followed.runs
    _shaded(one, followed.trial.truth.times_s, ~runs[FCDI].measured)
    for name, run in runs.items():
        size = np.linalg.norm(run.residual_force_n, axis=1)
        one.semilogy(run.times_s, np.maximum(size, 1e-2), color=COLOURS[name], lw=0.9, label=name)
    one.set_ylim(bottom=1e-2)
    labelled(one, "time (s)", "residual force (N)")
    legend(one)
    return figure


def _shaded(one: Axes, times: Array, where: BoolArray) -> None:
    edges = np.diff(np.concatenate([[0], where.astype(int), [0]]))
    for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        one.axvspan(times[begin], times[end - 1], color=SHADE, lw=0)


def survey_drawings(found: Survey, real: Sequence[RealScores]) -> Iterator[Drawing]:
    """All filters at a glance: errors by movement, delays and noise, residual on real captures.

    Args:
        found: The synthetic trials.
        real: The real captures; empty without any.
    """
    names = [name for name in (FCDI, FDMC_PER_FRAME, FDMC, DYNAMIC) if found.of(name)]
    numbers = (
        ("angle_deg", "angles (°)"),
        ("velocity_rad_s", "velocities (rad/s)"),
        ("torque_nm", "torques (N m)"),
    )
    yield Drawing(
        "own", "Errors by movement", _bars(found, numbers, names), "RMS over common trials, causal filters."
    )
    delays = (("velocity_delay_ms", "velocity delay (ms)"), ("torque_delay_ms", "torque delay (ms)"))
    yield Drawing("own", "Delay of the legs' curves", _bars(found, delays, names), "Mean over common trials.")
    if real:
        yield Drawing(
            "own", "Residual force on real captures", _real_bars(real, names), "RMS after correction."
        )


def _bars(found: Survey, numbers: Sequence[tuple[str, str]], names: Sequence[str]) -> Figure:
    movements = [movement for movement in MOVEMENTS if found.of(FCDI, movement)]
    same = {movement: found.common(names, movement) for movement in movements}
    figure, made = axes(len(numbers), height=2.0)
    for one, (number, head) in zip(made, numbers, strict=True):
        groups = [[same[movement].pooled(name, movement, number) for movement in movements] for name in names]
        _grouped(one, groups, names, [_broken(movement) for movement in movements])
        labelled(one, "", head)
    legend(made[0])
    return figure


def _broken(words: str) -> str:
    return words.replace(", ", ",\n").replace(" movement", "\nmovement")


def _real_bars(real: Sequence[RealScores], names: Sequence[str]) -> Figure:
    captures = list(dict.fromkeys(one.capture for one in real))
    value = {(one.capture, one.filter): np.nan if one.lost else one.residual_n for one in real}
    figure, (one,) = axes(height=2.8)
    groups = [[value.get((capture, name), np.nan) for capture in captures] for name in names]
    _grouped(one, groups, names, [capture.replace(" ", "\n") for capture in captures])
    one.set_yscale("log")
    labelled(one, "", "residual force (N)")
    legend(one)
    return figure


def _grouped(
    one: Axes, groups: Sequence[Sequence[float]], names: Sequence[str], ticks: Sequence[str]
) -> None:
    width = 0.8 / len(names)
    for k, (name, values) in enumerate(zip(names, groups, strict=True)):
        at = np.arange(len(ticks)) + (k - 0.5 * (len(names) - 1)) * width
        one.bar(at, values, width, color=COLOURS[name], label=name)
    one.set_xticks(range(len(ticks)), ticks)
    one.axhline(0.0, color="#5b636b", lw=0.7)
