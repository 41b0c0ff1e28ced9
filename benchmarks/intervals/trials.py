"""One synthetic trial with a body scaled from captures: errors over stated standard deviations.

A trial and a static capture are made of a person whose body is known exactly, and whose joint centres and skin are a
draw from the spreads that the filters count on (:mod:`mbkf.synthesis.anatomy`). The body is then scaled from the static
alone, or from the static and the trial, as a laboratory would, and the trial is reconstructed causally and smoothed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.dynamic.methods import tared
from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.anatomy import true_angles
from mbkf.synthesis.capture import CaptureSettings
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.innovations import SETTLING_S
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

MOTIONS = ("walk", "squat", "jump")
SKIN_M = (0.0, 0.003, 0.005)
BODIES = ("static", "static + trial")
QUANTITIES = ("q", "v", "torque", "wrench")


@dataclass(frozen=True)
class Key:
    """A trial: motion, person (seed), skin (standard deviation, m), and what the body is scaled from."""

    motion: str
    person: int
    skin_m: float
    body: str


@dataclass(frozen=True)
class Judged:
    """A reconstruction against the truth.

    Attributes:
        key: The trial.
        smoothed: Whether later frames were used.
        nees: Mean of (error / sd)² by quantity: joint dofs of q, v and torque, both feet's wrenches.
        angle_cover, torque_cover: (A,) share of frames in which the 95 % interval holds the truth, by clinical angle of
            a joint and its moment.
        names: (A,) those angles.
        angle_rms_deg: RMS error of these angles.
    """

    key: Key
    smoothed: bool
    nees: tuple[float, ...]
    angle_cover: Array
    torque_cover: Array
    names: tuple[str, ...]
    angle_rms_deg: float


def judged(key: Key) -> tuple[Judged, Judged]:
    """The trial causally and smoothed."""
    with single_threaded():
        settings = CaptureSettings(skin_sd_m=key.skin_m)
        person, made = synthesise(key.motion, seed=key.person, settings=settings, varied=True)
    trial = tared(made.trial)
    moving = [trial] if key.body == "static + trial" else []
    subject = scale(made.static, moving, mass_kg=person.mass_kg, protocol=person.protocol)
    both = [
        reconstruct(trial, subject, settings=ReconstructSettings(smooth=smooth, checks=False))
        for smooth in (False, True)
    ]
    return against(key, both[0], made.truth, person), against(key, both[1], made.truth, person)


def against(key: Key, found: Reconstruction, truth: Truth, person: Subject) -> Judged:
    """A reconstruction's errors over its stated standard deviations.

    Args:
        key: The trial.
        found: Its reconstruction.
        truth: The truth in the same frames.
        person: The true person.
    """
    model = HumanModel.of(found.subject)
    settled = (found.times_s >= found.times_s[0] + SETTLING_S) & found.tracked
    q = np.array([model.difference(a, b) for a, b in zip(found.q[settled], truth.q[settled], strict=True)])
    joints = slice(ROOT_DOFS, None)
    wrench_sd = np.full(found.foot_wrench.shape, np.nan)
    if found.foot_wrench_sd is not None:
        wrench_sd = found.foot_wrench_sd
    ratios = (
        q[:, joints] / found.sd_q[settled, joints],
        (truth.v - found.v)[settled, joints] / found.sd_v[settled, joints],
        (truth.tau - found.tau)[settled, joints] / found.sd_tau[settled, joints],
        (truth.foot_wrench - found.foot_wrench)[settled] / wrench_sd[settled],
    )
    clinical = ClinicalAngles(model)
    of_joints = clinical.rotational.copy()
    of_joints[clinical.root_angles] = False
    away = true_angles(person, truth.q) - found.angles
    angle = np.angle(np.exp(1j * away))[settled][:, of_joints]
    moment = (clinical.moments(truth.q, truth.tau) - found.moments)[settled][:, of_joints]
    return Judged(
        key,
        found.smoothed,
        tuple(_mean_square(ratio) for ratio in ratios),
        _cover(angle, found.angles_sd[settled][:, of_joints]),
        _cover(moment, found.moments_sd[settled][:, of_joints]),
        tuple(name for name, own in zip(clinical.names, of_joints, strict=True) if own),
        float(np.degrees(np.sqrt(np.nanmean(angle**2)))),
    )


def _mean_square(ratio: Array) -> float:
    known = ratio[np.isfinite(ratio)]
    return float(np.mean(known**2)) if known.size else float("nan")


def _cover(error: Array, sd: Array) -> Array:
    return np.asarray((np.abs(error) <= 1.959964 * sd).mean(axis=0))
