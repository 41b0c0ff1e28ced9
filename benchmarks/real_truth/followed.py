"""Persons scaled as `mbkf batch` scales them, their trials followed, and the differences from the references."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.foreign.errors import Series
from benchmarks.real_truth.hips import hip_distances
from benchmarks.real_truth.pelvis import pelvis_lines
from benchmarks.real_truth.persons import STANDING, RealPerson, RealTrial
from benchmarks.real_truth.reference import Curves, read_reference
from benchmarks.references import Curve, correlation
from mbkf.conventions import SIDES, Array
from mbkf.io.contacts import Source
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.study.scaling.session import SessionTrial, scale_from_session
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

STATIC, SESSION = "static", "session"
SCALINGS = (SESSION, STATIC)


@dataclass(frozen=True)
class Job:
    """A person and the way of scaling: :data:`STATIC` or :data:`SESSION`."""

    data: Path
    person: RealPerson
    scaling: str


@dataclass(frozen=True)
class Compared:
    """A trial beside its reference.

    Attributes:
        person, kind, trial: Of whom, by which program, which movement.
        marker_rms_mm: RMS distance of measured and reconstructed markers.
        angles, moments: Differences, ours minus theirs, degrees and N m/kg; moments where a plate reads the foot.
        r: Correlation by (group, name), groups "angle" and "moment".
        tilt_deg, line_deg: Change of the mean pelvis tilt since the standing trial, of ours, and of the line from the
            markers at sacrum or PSIS to those at the ASIS, backward positive; NaN where these are not worn.
        residual_n: RMS force that our inverse dynamics after the marker filter leaves at the pelvis, and that of the
            reference.
        hips_mm: By side, distance of our hip centre from functional ones of the laboratory, and their spread; empty
            without such points.
    """

    person: str
    kind: str
    trial: str
    marker_rms_mm: float
    angles: tuple[Series, ...]
    moments: tuple[Series, ...]
    r: dict[tuple[str, str], float]
    tilt_deg: float
    line_deg: float
    residual_n: tuple[float, float]
    hips_mm: dict[str, tuple[float, float]]


def followed(job: Job) -> list[Compared]:
    """All trials of a person.

    Args:
        job: Person and scaling.
    """
    person = job.person
    with single_threaded():
        captures = {one.name: person.trial(job.data, one) for one in person.trials}
        static = person.standing(job.data)
        subject = _scaled(job, static, captures)
        standing = np.full(2, np.nan)
        if static is not None:
            markers = ReconstructSettings(filter="kinematic")
            standing = pelvis_lines(reconstruct(replace(static, plates=()), subject, settings=markers))
        return [_compared(job, one, captures[one.name], subject, standing) for one in person.trials]


def _scaled(job: Job, static: Capture | None, captures: dict[str, Capture]) -> Subject:
    """The person; without a standing trial, from the walk."""
    by = partial(scale, mass_kg=job.person.mass_kg)
    if static is None:
        return by(None, list(captures.values())[:1])
    if job.scaling == STATIC:
        return by(static)
    moving = [SessionTrial(name, partial(_same, one)) for name, one in captures.items() if name != STANDING]
    return scale_from_session(SessionTrial(STANDING, partial(_same, static)), moving, by).subject


def _same(capture: Capture) -> Capture:
    return capture


def _compared(job: Job, one: RealTrial, capture: Capture, subject: Subject, standing: Array) -> Compared:
    """A trial beside its reference; ``standing`` has tilt and line of the standing trial."""
    person = job.person
    settings = ReconstructSettings(filter="dynamic" if one.loads else "kinematic", angles=person.reading)
    found = reconstruct(capture, subject, settings=settings)
    reference = read_reference(job.data, person, one, capture)
    angles, moments, r = [], [], {}
    for name, curve in reference.angles.items():
        ours, theirs = np.degrees(found.angle(name)), _at(found, curve)
        sds = [np.degrees(found.angle_sd(name, part)) for part in ("total", "varying")]
        r["angle", name] = _r(ours, theirs)
        angles.append(Series(person.name, one.name, "angle", name, ours - theirs, *sds))
    for name, curve in reference.moments.items() if one.loads else ():
        read = found.foot_source[:, SIDES.index(name[-1])] == Source.MEASURED
        ours = found.moment(name) / person.mass_kg
        theirs = np.where(found.valid & read, _at(found, curve), np.nan)
        sds = [found.moment_sd(name, part) / person.mass_kg for part in ("total", "varying")]
        if np.isfinite(theirs).any():
            r["moment", name] = _r(ours, theirs)
            moments.append(Series(person.name, one.name, "moment", name, ours - theirs, *sds))
    tilt, line = pelvis_lines(found) - standing
    away = np.linalg.norm(found.measured_m - found.predicted_m, axis=2)
    return Compared(
        person.name, person.kind, one.name, 1e3 * float(np.sqrt(np.nanmean(away**2))),
        tuple(angles), tuple(moments), r, tilt, line,
        (_residual_n(capture, subject, reference), reference.residual_n), hip_distances(capture, found),
    )  # fmt: skip


def _at(found: Reconstruction, curve: Curve) -> Array:
    """(T,) reference at our frames; NaN before, after and in its gaps, and where we track nothing."""
    known = np.isfinite(curve.values)
    there = np.interp(found.times_s, curve.times_s[known], curve.values[known], np.nan, np.nan)
    near = np.interp(found.times_s, curve.times_s, known.astype(float), 0.0, 0.0) > 0.99
    return np.where(near & found.tracked, there, np.nan)


def _r(ours: Array, theirs: Array) -> float:
    both = np.isfinite(ours) & np.isfinite(theirs)
    return correlation(ours[both], theirs[both]) if both.sum() > 1 else float("nan")


def _residual_n(capture: Capture, subject: Subject, reference: Curves) -> float:
    """Residual of our marker filter in frames of the reference with all load on plates, N; NaN without it."""
    if not np.isfinite(reference.residual_n):
        return float("nan")
    found = reconstruct(capture, subject, settings=ReconstructSettings(filter="kinematic"))
    times = next(iter(reference.moments.values())).times_s
    inside = (found.times_s >= times[0]) & (found.times_s <= times[-1]) & found.measured
    return float(np.sqrt((found.residual_force_n[inside] ** 2).sum(axis=1).mean()))
