"""One trial of the campaign: scaled from its static capture, reconstructed causally and smoothed, judged by truth."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks.campaign.draw import Drawn, drawn, made
from benchmarks.dynamic.methods import tared
from benchmarks.intervals.trials import Judged, Key, against
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.anatomy import true_angles
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.innovations import SETTLING_S
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.scale import scale


@dataclass(frozen=True)
class Error:
    """Errors of one reconstruction.

    Attributes:
        smoothed: Whether later frames were used.
        angle_rms_deg: (A,) RMS error of each angle of a joint; infinite where a frame has no finite one.
        angle_doubt: (A,) RMS of error over stated standard deviation.
        angle_names: (A,) their names.
        torque_nm: (nv − 6,) RMS error of the joints' torques in frames that have them; NaN where none does.
        tracked: Share of the frames with markers after the start that are tracked.
        judged: NEES and coverage.
    """

    smoothed: bool
    angle_rms_deg: Array
    angle_doubt: Array
    angle_names: tuple[str, ...]
    torque_nm: Array
    tracked: float
    judged: Judged

    @property
    def worst_deg(self) -> float:
        """RMS error of the worst angle."""
        return float(self.angle_rms_deg.max())

    @property
    def worst_angle(self) -> str:
        """Name of that angle."""
        return self.angle_names[int(self.angle_rms_deg.argmax())]


@dataclass(frozen=True)
class Outcome:
    """What became of a trial.

    Attributes:
        trial: What the seed stands for.
        errors: Causal and smoothed; empty where it was refused or failed.
        refused: The program's own error, "" for none.
        failed: An error or a warning of another kind, "" for none.
        seconds: Computing time of synthesis, scaling and both reconstructions.
    """

    trial: Drawn
    errors: tuple[Error, ...]
    refused: str
    failed: str
    seconds: float


def outcome(seed: int) -> Outcome:
    """Makes, scales, reconstructs and judges the trial of a seed; whatever is raised is told and not raised."""
    trial, begin = drawn(seed), process_time()
    errors: tuple[Error, ...] = ()
    refused = failed = ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            errors = _errors(trial)
    except MbkfError as error:
        refused = f"{type(error).__name__}: {' '.join(str(error).split())}"
    except Exception as error:  # any other error is what the campaign looks for
        failed = f"{type(error).__name__}: {error}"
    return Outcome(trial, errors, refused, failed, process_time() - begin)


def _errors(trial: Drawn) -> tuple[Error, ...]:
    with single_threaded():
        person, capture = made(trial)
    recorded = tared(capture.trial)
    subject = scale(capture.static, [], mass_kg=person.mass_kg, protocol=person.protocol)
    found = (
        reconstruct(recorded, subject, settings=ReconstructSettings(smooth=smooth, checks=False))
        for smooth in (False, True)
    )
    return tuple(error_of(trial, one, capture.truth, person) for one in found)


def error_of(trial: Drawn, found: Reconstruction, truth: Truth, person: Subject) -> Error:
    """Errors of a reconstruction after it has settled, in tracked frames.

    Args:
        trial: What the seed stands for.
        found: The reconstruction.
        truth: The truth in the same frames.
        person: The true person.
    """
    after = found.times_s >= found.times_s[0] + SETTLING_S
    with_markers = after & np.isfinite(found.measured_m).any(axis=(1, 2))
    settled = after & found.tracked
    clinical = ClinicalAngles(HumanModel.of(found.subject))
    of_joints = clinical.rotational.copy()
    of_joints[clinical.root_angles] = False
    away = true_angles(person, truth.q) - found.angles
    error = np.angle(np.exp(1j * away))[settled][:, of_joints]
    sd = found.angles_sd[settled][:, of_joints]
    torque = (truth.tau - found.tau)[settled, ROOT_DOFS:]
    key = Key(trial.motion, trial.seed, trial.errors.skin_sd_m, "static")
    return Error(
        found.smoothed,
        np.where(np.isfinite(error).all(axis=0), np.degrees(_rms(error)), np.inf),
        _rms(error / sd),
        tuple(name for name, own in zip(clinical.names, of_joints, strict=True) if own),
        _rms(torque),
        float(found.tracked[with_markers].mean()) if with_markers.any() else 0.0,
        against(key, found, truth, person),
    )


def _rms(values: Array) -> Array:
    """Root mean square along the first axis of what is finite, NaN where nothing is."""
    finite = np.isfinite(values)
    count = finite.sum(axis=0)
    total = np.where(finite, values, 0.0)
    mean = np.where(count > 0, (total**2).sum(axis=0) / np.maximum(count, 1), np.nan)
    return np.asarray(np.sqrt(mean))
