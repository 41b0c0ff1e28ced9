"""The whole chain on an unlabelled synthetic capture with known truth: scale, label, reconstruct, compare."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.io.atomic import check_folder
from mbkf.io.capture import read_capture
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import RESULT_FILES, Summary, write_reconstruction
from mbkf.io.subject import write_subject
from mbkf.io.truth import Truth
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.trial.label import label
from mbkf.trial.labelling.files import write_labels
from mbkf.trial.labelling.result import LabelSummary
from mbkf.trial.labelling.score import score
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.scale import scale
from mbkf.trial.synth import FILES, synthesise, write_folder

COORDINATES = (
    "hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l", "ankle_angle_l",
    "lumbar_extension", "arm_flex_r", "elbow_flex_r",
)  # fmt: skip
"""The coordinates whose errors the demo lists."""


LABELLED = "labelled.c3d"
"""The raw capture with its labels."""


@dataclass(frozen=True)
class CoordinateError:
    """Error of one coordinate against the truth: angles in rad, moments in N m.

    Attributes:
        name: Clinical coordinate.
        angle_offset: Mean difference of the angle, from different axes of the scaled segment.
        angle_rms: RMS of the angle without that offset.
        moment_rms: RMS of the torque.
        moment_range: Range of the true torque.
    """

    name: str
    angle_offset: float
    angle_rms: float
    moment_rms: float
    moment_range: float


@dataclass(frozen=True)
class Demo:
    """Results of the demo: the folder, the labels, the reconstruction, its summary and errors of a few coordinates."""

    folder: Path
    labels: LabelSummary
    result: Reconstruction
    summary: Summary
    errors: tuple[CoordinateError, ...]


def run_demo(
    motion: str,
    folder: str | Path,
    *,
    seconds: float | None = None,
    seed: int = 0,
    filter_name: str = "dynamic",
    progress: StageCallback | None = None,
) -> Demo:
    """Synthetic capture → subject scaled from the standing trial → labels → reconstruction → errors.

    Args:
        motion: Name of a registered motion, see :mod:`mbkf.synthesis.motions`.
        folder: Folder of the capture; the result is in its subfolder ``result``.
        seconds: Duration; the motion's usual one when None.
        seed: Chooses person, motion and noise.
        filter_name: Name of the filter.
        progress: Called with the stage, items done and items in all.

    Raises:
        MbkfError: The folder is a file, or motion, duration or filter is impossible.
    """
    folder = check_folder(folder, (*FILES, "scaled.toml", LABELLED))
    check_folder(folder / "result", RESULT_FILES)
    person, capture = synthesise(motion, seconds=seconds, seed=seed, progress=progress)
    write_folder(person, capture, folder)
    static = read_capture(folder / "static.c3d")
    subject = scale(static, mass_kg=person.mass_kg, progress=progress)
    write_subject(subject, folder / "scaled.toml")
    settings = ReconstructSettings(filter=filter_name, keep_covariance=True)
    raw = read_capture(folder / "raw.c3d")
    found = label(raw, subject, progress=progress)
    compared = score(found.markers, capture.trial.markers, subject)
    labels = write_labels(raw, found, folder / LABELLED, compared)
    result = reconstruct(read_capture(folder / LABELLED), subject, settings=settings, progress=progress)
    summary = summarise(result, capture.truth)
    write_reconstruction(result, summary, folder / "result")
    body = HumanModel.of(person)
    return Demo(folder, labels, result, summary, coordinate_errors(result, capture.truth, body))


def coordinate_errors(result: Reconstruction, truth: Truth, body: HumanModel) -> tuple[CoordinateError, ...]:
    """Errors of the listed coordinates over tracked frames.

    Args:
        result: The reconstruction, on the truth's frames.
        truth: The true motion.
        body: The true body.
    """
    clinical = ClinicalAngles(body)
    angles = clinical.angles(truth.q)
    moments = clinical.moments(truth.q, truth.tau, angles)
    errors = []
    for name in COORDINATES:
        column = clinical.names.index(name)
        angle = (result.angle(name) - angles[:, column])[result.tracked]
        moment = (result.moment(name) - moments[:, column])[result.tracked & result.measured]
        errors.append(
            CoordinateError(
                name=name,
                angle_offset=float(np.nanmean(angle)),
                angle_rms=float(np.nanstd(angle)),
                moment_rms=float(np.sqrt(np.nanmean(moment**2))) if len(moment) else float("nan"),
                moment_range=float(np.ptp(moments[:, column])),
            )
        )
    return tuple(errors)
