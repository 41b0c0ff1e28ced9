"""Five hundred spoilt trials: what a verdict knows of each, and how wrong its results are against the right ones."""

from __future__ import annotations

import hashlib
import pickle
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

import numpy as np

import benchmarks
import mbkf
from benchmarks.limbs.faults import ThrownFilter
from benchmarks.verdict.errors import errors
from benchmarks.verdict.faults import KINDS
from benchmarks.verdict.recorded import Base, Thrown, bases, load
from benchmarks.verdict.trials import WRONG_DEG, WRONG_NM_PER_KG, Judged
from mbkf.errors import MbkfError
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.results import Reconstruction
from mbkf.model.limbs import limbs
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.verdict.evidence import Evidence, evidence_of
from mbkf.trial.verdict.judge import judge

NUMBER = re.compile(r"\d+")

RIGHT = ""
"""Kind of a trial without a fault."""


@dataclass(frozen=True)
class Spoilt:
    """A trial with a fault.

    Attributes:
        base: The trial without it.
        kind: A key of :data:`benchmarks.verdict.faults.KINDS`; :data:`RIGHT` for no fault.
    """

    base: Base
    kind: str = RIGHT

    @property
    def seed(self) -> list[int]:
        """Numbers that choose the fault's size and place."""
        return list(hashlib.sha256(f"{self.base.label}, {self.kind}".encode()).digest()[:8])


@dataclass(frozen=True)
class Found:
    """Findings on a trial.

    Attributes:
        trial: The trial.
        fault: The fault with its size and names.
        refused: The message of a refusal; empty where there is a result.
        evidence: What the verdict rests on; None after a refusal.
        angle_deg, torque_nm_per_kg: Largest error of each leg's sagittal angles and torques, by the part of the
            verdict: root mean square over the frames that count.
    """

    trial: Spoilt
    fault: str
    refused: str
    evidence: Evidence | None
    angle_deg: Mapping[str, float]
    torque_nm_per_kg: Mapping[str, float]

    @property
    def label(self) -> str:
        """The trial in rows."""
        fault = f", {self.trial.kind} ({self.fault})" if self.trial.kind else ""
        return f"{self.trial.base.label}{fault}"

    @property
    def judged(self) -> Judged:
        """The judgement: errors of legs that may be used."""
        if self.evidence is None:
            return Judged(self.label, "refused", float("nan"), float("nan"), self.refused)
        verdict = judge(self.evidence)
        angle, torque = (
            max([0.0, *(error for part, error in of.items() if verdict.may_use(part))])
            for of in (self.angle_deg, self.torque_nm_per_kg)
        )
        return Judged(self.label, verdict.overall, angle, torque, verdict.line)

    @property
    def wrong(self) -> bool:
        """True where a leg's results are wrong, whether they may be used or not."""
        angle, torque = (max(of.values(), default=0.0) for of in (self.angle_deg, self.torque_nm_per_kg))
        return angle > WRONG_DEG or torque > WRONG_NM_PER_KG

    @property
    def reasons(self) -> frozenset[tuple[str, str]]:
        """Words with the meanings of their reasons, without numbers, against parts that the capture shows."""
        if self.evidence is None:
            return frozenset()
        reasons = judge(self.evidence).reasons
        return frozenset((one.word, NUMBER.sub("…", one.means)) for one in reasons if one.shown)


def spoilt_trials(data: Path, quick: bool = False) -> list[Spoilt]:
    """Every base with every kind of fault, base by base.

    Args:
        data: Folder of the reference captures.
        quick: Every thirteenth of them.
    """
    found = [Spoilt(base, kind) for base in bases(data) for kind in KINDS]
    return found[::13] if quick else found


def followed(trial: Spoilt) -> Found:
    """Puts the fault into the trial and reconstructs it.

    Args:
        trial: The trial.
    """
    with single_threaded():
        recorded, right = load(trial.base)
        fault = ""
        try:
            if trial.kind:
                recorded, fault = KINDS[trial.kind](recorded, np.random.default_rng(trial.seed))
            # Evidence is that of the result before its verdict takes frames away.
            with _thrown(recorded.thrown), patch("mbkf.trial.verdict.judge.judged_result", _as_it_is):
                found = reconstruct(recorded.capture, recorded.person())
        except MbkfError as error:
            return Found(trial, fault, str(error), None, {}, {})
        return Found(trial, fault, "", evidence_of(found), *errors(found, right))


def sources_folder(out: Path) -> Path:
    """The folder of the findings that these sources make, below a folder; those of other sources are left alone.

    Args:
        out: The folder.
    """
    digest = hashlib.sha256()
    for package in (Path(benchmarks.__file__).parent / "verdict", Path(mbkf.__file__).parent):
        for path in sorted(package.rglob("*.py")):
            digest.update(path.read_bytes())
    folder = out / f"spoilt_{digest.hexdigest()[:12]}"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def stored(trial: Spoilt, folder: Path) -> Found:
    """The findings on a trial, kept in a file so that a run that stopped goes on where it was.

    Args:
        trial: The trial.
        folder: Where findings are kept; of one state of the sources.
    """
    digest = hashlib.sha256(f"{trial.base.label}, {trial.kind}".encode()).hexdigest()[:16]
    path = folder / f"{digest}.pickle"
    if path.is_file():
        kept = pickle.loads(path.read_bytes())
        assert isinstance(kept, Found)
        return kept
    found = followed(trial)
    partial = path.with_suffix(".partial")
    partial.write_bytes(pickle.dumps(found))
    partial.replace(path)
    return found


def _as_it_is(found: Reconstruction) -> Reconstruction:
    return found


@contextmanager
def _thrown(thrown: Thrown | None) -> Iterator[None]:
    """Throws the filter of the reconstruction inside into a wrong pose."""
    if thrown is None:
        yield
        return

    def made(name: str, inputs: object, *more: object) -> TrackingFilter:
        filter = tracking_filter(name, inputs, *more)  # type: ignore[arg-type]
        limb = next(one for one in limbs(filter.model) if one.name == thrown.limb)
        return ThrownFilter(filter, thrown.kind, limb, thrown.frame)

    with patch("mbkf.trial.reconstruct.tracking_filter", made):
        yield


def by_kind(found: Sequence[Found]) -> dict[str, list[Found]]:
    """Findings by kind of fault."""
    held: dict[str, list[Found]] = {}
    for one in found:
        held.setdefault(one.trial.kind, []).append(one)
    return held
