"""Trials that bounds of verdicts were not set on, right and with a fault, and how wrong a faulty result is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.loads.faults import Clock, Fault, Mass, With
from benchmarks.loads.trials import Trial
from mbkf.conventions import Array, BoolArray
from mbkf.errors import MbkfError
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.verdict import LOAD_PARTS, Verdict, Word
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.checks.orientation import laid
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.verdict.judge import verdict_of
from mbkf.trial.verdict.parts import LEGS

MOTIONS, SEEDS, FAULTY_SEEDS = ("walk", "jump", "step_up", "turn", "squat"), (3, 4, 5), (3, 4)
"""Synthetic trials that no bound was set on."""

ANGLES = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")
"""Sagittal angles of the legs, and their torques."""

WRONG_DEG, WRONG_NM_PER_KG = 10.0, 0.3
"""Errors from which a result is wrong: root mean square over frames in which it may be used."""


@dataclass(frozen=True)
class Turned:
    """All plates are taken as turned about the vertical.

    Attributes:
        quarters: By so many quarters.
    """

    quarters: int

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"plates turned by {90 * self.quarters}°"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture with turned plates."""
        return (
            replace(capture, plates=tuple(laid(p, self.quarters, False) for p in capture.plates)),
            subject,
            None,
        )


@dataclass(frozen=True)
class AnotherPerson:
    """The subject file belongs to another person.

    Attributes:
        seed: Of that person.
    """

    seed: int

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"another person ({self.seed})"

    def put_into(self, capture: Capture, subject: Subject) -> With:  # noqa: ARG002
        """The other person."""
        return capture, synthesise_subject(self.seed), None


@dataclass(frozen=True)
class Exchanged:
    """Two markers have each other's names throughout.

    Attributes:
        pair: Their names.
    """

    pair: tuple[str, str]

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"{self.pair[0]} and {self.pair[1]} exchanged"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture with these names exchanged."""
        other = dict((self.pair, self.pair[::-1]))
        names = tuple(other.get(name, name) for name in capture.markers.names)
        return replace(capture, markers=replace(capture.markers, names=names)), subject, None


FAULTS: tuple[Fault, ...] = (
    Mass(1.3),
    Mass(0.7),
    Clock(0.06),
    Clock(-0.06),
    Turned(1),
    Turned(2),
    AnotherPerson(11),
    AnotherPerson(12),
    Exchanged(("RKNE", "LKNE")),
    Exchanged(("RANK", "RKNE")),
)


@dataclass(frozen=True)
class Judged:
    """Judgement of a trial.

    Attributes:
        label: The trial.
        word: The word of the whole trial; "refused" if `reconstruct` refuses the capture.
        angle_deg, torque_nm_per_kg: Largest error of a leg's sagittal angle or torque among results that may be used,
            against those without the fault; NaN of a right trial.
        line: The verdict in a line.
    """

    label: str
    word: Word | str
    angle_deg: float
    torque_nm_per_kg: float
    line: str

    @property
    def wrong_in_use(self) -> bool:
        """True for a wrong result under "use"."""
        wrong = self.angle_deg > WRONG_DEG or self.torque_nm_per_kg > WRONG_NM_PER_KG
        return self.word == "use" and wrong


def shown_right(data: Path, quick: bool = False) -> list[Trial]:
    """Right trials.

    Args:
        data: Folder of the reference captures.
        quick: Every fifth of them.
    """
    found = [Trial("own", motion, data, seed) for motion in MOTIONS for seed in SEEDS]
    return found[::5] if quick else found


def shown_faulty(data: Path, quick: bool = False) -> list[Trial]:
    """Walks and squats with a fault.

    Args:
        data: Folder of the reference captures.
        quick: Every fifth of them.
    """
    motions = ("walk", "squat")
    found = [
        Trial("own", motion, data, seed, fault)
        for motion in motions
        for seed in FAULTY_SEEDS
        for fault in FAULTS
    ]
    return found[::5] if quick else found


def judged(trial: Trial) -> Judged:
    """Reconstructs and judges a trial; a faulty one is compared with the same trial without its fault.

    Args:
        trial: The trial.
    """
    settings = ReconstructSettings(other_contacts=not trial.feet_only)
    with single_threaded():
        capture, subject, _ = trial.load()
        try:
            found = reconstruct(capture, subject, settings=settings)
        except MbkfError as error:
            return Judged(trial.label, "refused", float("nan"), float("nan"), str(error))
        if trial.fault is None:
            return _judged(trial, found, float("nan"), float("nan"))
        capture, subject, _ = replace(trial, fault=None).load()
        right = reconstruct(capture, subject, settings=settings)
    return _judged(trial, found, *_errors(found, right, verdict_of(found)))


def _judged(trial: Trial, found: Reconstruction, angle_deg: float, torque: float) -> Judged:
    verdict = verdict_of(found)
    return Judged(trial.label, verdict.overall, angle_deg, torque, verdict.line)


def _errors(found: Reconstruction, right: Reconstruction, verdict: Verdict) -> tuple[float, float]:
    """Largest error of an angle, degrees, and of a torque, N m/kg, of legs that may be used."""
    angles, torques = [0.0], [0.0]
    for name in ANGLES:
        side = 0 if name.endswith("_r") else 1
        if verdict.may_use(LEGS[side]):
            angles.append(float(np.rad2deg(_rms(found.angle(name) - right.angle(name), found.tracked))))
        if verdict.may_use(LOAD_PARTS[side]):
            per_kg = found.moment(name) / found.subject.mass_kg - right.moment(name) / right.subject.mass_kg
            torques.append(_rms(per_kg, found.valid))
    return max(angles), max(torques)


def _rms(error: Array, counts: BoolArray) -> float:
    known = error[counts & np.isfinite(error)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else 0.0
