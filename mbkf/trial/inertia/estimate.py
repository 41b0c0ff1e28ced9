"""Segment masses and centres of mass from whole trials with plates: offered with their evidence, never forced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import NotObservable
from mbkf.io.inertia import SegmentInertia
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from mbkf.numerics.correlated_regression import Belief, Series, regress
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.correction import correct_markers
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.inertia.prior import PLACE, inertia_prior
from mbkf.trial.inertia.rows import STEP_S, TrialRows, trial_rows
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.preparation.static_names import markers_as_scaled

INERTIA_KEY = "inertia"
"""Key of a subject's report for its inertial parameters as estimated from plates."""

LINEARISATIONS = 3
"""Number of linearisations of masses times shifts."""

LEAST_SAMPLES, LEAST_EACH = 30, 14
"""Samples with one before them, 0.05 s apart, that trials have to give in all; a trial with fewer does not count."""

LEAST_FACTOR = 0.2
"""A segment's mass over the table's, at least: a smaller estimate is not physical."""


@dataclass(frozen=True)
class InertiaEstimate:
    """Estimate of a person's segments from plates.

    Attributes:
        subject: The person with these inertial parameters and mass.
        mean: (4 S + 2 K,) by segment, relative change of mass and shift of the centre of mass, m, against the table;
            then by capture, how far plates lie beside their place, forward and left, m.
        log_ratio: Evidence for them against the table, nats: ln of the ratio of marginal likelihoods.
        held_out_log_ratio: The same of each trial by the estimate from the others, summed; of one trial, of its halves.
        mass_sd_kg: Standard deviation of the whole mass.
        before, after: Root mean square of the force N and moment N m that plates, at their found places, lack by the
            table and by these.
        captures: Names of the captures used.
        seconds: How much of them counted.
    """

    subject: Subject
    mean: Array
    log_ratio: float
    held_out_log_ratio: float
    mass_sd_kg: float
    before: tuple[float, float]
    after: tuple[float, float]
    captures: tuple[str, ...]
    seconds: float

    @property
    def supported(self) -> bool:
        """True where the evidence is for these parameters, on the data they were found from and on held-out data."""
        masses = [one.mass_factor for one in self.subject.inertia.values()]
        return bool(self.log_ratio > 0.0 and self.held_out_log_ratio > 0.0 and min(masses) > LEAST_FACTOR)


def estimate_inertia(subject: Subject, captures: Sequence[Capture]) -> InertiaEstimate:
    """Masses and centres of mass of the segments, from trials with plates.

    Args:
        subject: The scaled person; inertial parameters of its own do not count.
        captures: Captures of the person; those with plates count.

    Raises:
        NotObservable: No capture shows enough.
    """
    subject = replace(subject, inertia={})
    regressor = InertialRegressor(HumanModel.of(subject))
    with single_threaded():
        usable = [(Path(one.path).name, _rows(regressor, subject, one)) for one in captures if one.plates]
        usable = [(name, rows) for name, rows in usable if rows.follows.sum() >= LEAST_EACH]
        if sum(int(rows.follows.sum()) for _, rows in usable) < LEAST_SAMPLES:
            raise NotObservable(
                "no trial shows the inertia of segments: that needs 1.5 s and more in which only feet on plates bear"
            )
        return estimate_from_rows(
            subject, regressor, [rows for _, rows in usable], tuple(name for name, _ in usable)
        )


def with_inertia(subject: Subject, captures: Sequence[Capture]) -> Subject:
    """The person with segments by the plates where the evidence is for that, and a note of it in the report.

    Args:
        subject: The scaled person.
        captures: Captures of the person.
    """
    try:
        found = estimate_inertia(subject, captures)
    except NotObservable as error:
        note: dict[str, object] = {"written": False, "told": f"inertia by the table: {error}"}
        return replace(subject, inertia={}, report={**subject.report, INERTIA_KEY: note})
    chosen = found.subject if found.supported else replace(subject, inertia={})
    return replace(chosen, report={**subject.report, INERTIA_KEY: _note(found, subject.mass_kg)})


def _note(found: InertiaEstimate, stated_kg: float) -> dict[str, object]:
    """Plain data about an estimate, for the subject's report."""
    verdict = "written" if found.supported else "the evidence is not for them, so the table is kept"
    remark = (
        f"inertia by the plates of {', '.join(found.captures)} ({found.seconds:.1f} s): {verdict}; "
        f"ln evidence ratio against the table {found.log_ratio:+.1f}, held out {found.held_out_log_ratio:+.1f}; "
        f"plates lack {found.before[0]:.1f} N, {found.before[1]:.2f} N m by the table, {found.after[0]:.1f} N, "
        f"{found.after[1]:.2f} N m by these; mass {found.subject.mass_kg:.1f} ± {found.mass_sd_kg:.1f} kg, "
        f"stated {stated_kg:.1f} kg"
    )
    segments = {
        name: {
            "mass_percent": 100.0 * (own.mass_factor - 1.0),
            "mass_percent_sd": 100.0 * own.mass_factor_sd,
            "centre_shift_mm": [1e3 * float(x) for x in own.centre_shift_m],
            "centre_shift_sd_mm": [1e3 * float(x) for x in own.centre_shift_sd_m],
        }
        for name, own in found.subject.inertia.items()
    }
    return {
        "written": found.supported,
        "told": remark,
        "log_ratio": found.log_ratio,
        "held_out_log_ratio": found.held_out_log_ratio,
        "segments": segments,
    }


def rows_of(subject: Subject, capture: Capture) -> tuple[InertialRegressor, TrialRows]:
    """Both sides of Newton's law in one capture, by the parameters of the subject's body.

    Raises:
        NotObservable: The capture has too few of the subject's markers.
        NotConverged: They do not fit the body.
    """
    regressor = InertialRegressor(HumanModel.of(subject))
    with single_threaded():
        return regressor, _rows(regressor, subject, capture)


def _rows(regressor: InertialRegressor, subject: Subject, capture: Capture) -> TrialRows:
    checked = checked_for_subject(capture, subject)
    shown = markers_as_scaled(checked.markers, subject)
    subject = correct_markers(subject, shown)
    inputs, recording = trial_inputs(shown, checked.plates, subject, ReconstructSettings(), body_errors=False)
    motion = markers_alone(inputs, recording)
    evidence = Evidence.of(inputs.sensor.model, motion, shown.times_s, shown.rate_hz, inputs.plates)
    return trial_rows(regressor, motion, evidence, evidence.clear)


def estimate_from_rows(
    subject: Subject, regressor: InertialRegressor, rows: Sequence[TrialRows], names: tuple[str, ...]
) -> InertiaEstimate:
    """The estimate from trials.

    Args:
        subject: The person by the table.
        regressor: Its body.
        rows: The trials' samples.
        names: The captures' names.
    """
    prior = inertia_prior(regressor, len(rows))
    mean, found = prior.mean, None
    for _ in range(LINEARISATIONS):
        found = regress([one.series(regressor, mean, k) for k, one in enumerate(rows)], prior)
        mean = found.posterior.mean
    assert found is not None
    size = PER_OWN * len(regressor.names)
    differs, sd = mean[:size], np.sqrt(np.diag(found.posterior.covariance))[:size]
    covariance = found.posterior.covariance[:size:PER_OWN, :size:PER_OWN]
    masses = regressor.table()[::PER_SEGMENT]
    own = {
        name: SegmentInertia(float(1.0 + d[0]), read_only(d[1:]), float(s[0]), read_only(s[1:]))
        for name, d, s in zip(
            regressor.names, differs.reshape(-1, PER_OWN), sd.reshape(-1, PER_OWN), strict=True
        )
    }
    whole = float(masses @ (1.0 + differs[::PER_OWN]))
    series = _series(regressor, rows)
    by_table = regress(_table_only(series, size), _only_places(prior, size))
    return InertiaEstimate(
        replace(subject, mass_kg=whole, inertia=own),
        read_only(mean),
        found.log_evidence - by_table.log_evidence,
        _held_out(regressor, rows if len(rows) > 1 else halves(rows[0])),
        float(np.sqrt(masses @ covariance @ masses)),
        lacking(regressor, rows, np.append(np.zeros(size), by_table.posterior.mean)),
        lacking(regressor, rows, mean),
        names,
        sum(len(one.given) for one in rows) * STEP_S,
    )


def lacking(regressor: InertialRegressor, rows: Sequence[TrialRows], mean: Array) -> tuple[float, float]:
    """Root mean square of the force N and moment N m that plates lack.

    Args:
        regressor: The body by the table.
        rows: Samples of K trials.
        mean: (4 S + 2 K,) as of :class:`InertiaEstimate`.
    """
    series = [one.series(regressor, mean, k) for k, one in enumerate(rows)]
    lack = np.concatenate([one.values - one.design @ mean for one in series])
    force, moment = (float(np.sqrt((part**2).sum(axis=1).mean())) for part in (lack[:, :3], lack[:, 3:]))
    return force, moment


def _held_out(regressor: InertialRegressor, rows: Sequence[TrialRows]) -> float:
    """Log evidence of each part by the estimate from the others against the table, nats, summed; short parts: 0."""
    size, prior, found = PER_OWN * len(regressor.names), inertia_prior(regressor, len(rows)), 0.0
    series = _series(regressor, rows)
    for k in range(len(series)):
        try:
            others = regress(series[:k] + series[k + 1 :], prior).posterior
            own = regress([series[k]], others)
            by_table = regress(_table_only([series[k]], size), _only_places(prior, size))
        except NotObservable:
            return 0.0
        found += own.log_evidence - by_table.log_evidence
    return found


def _series(regressor: InertialRegressor, rows: Sequence[TrialRows]) -> list[Series]:
    """The samples, linear about the table."""
    about = np.zeros(PER_OWN * len(regressor.names) + PLACE * len(rows))
    return [one.series(regressor, about, k) for k, one in enumerate(rows)]


def halves(rows: TrialRows) -> list[TrialRows]:
    """The first and the second half of a trial's samples."""
    middle = len(rows.given) // 2
    return [rows.part(slice(0, middle)), rows.part(slice(middle, None))]


def _table_only(series: Sequence[Series], size: int) -> list[Series]:
    """The same samples where segments are those of the table, and only the places of plates are unknown."""
    return [replace(one, design=one.design[..., size:]) for one in series]


def _only_places(prior: Belief, size: int) -> Belief:
    return Belief(prior.mean[size:], prior.precision[size:, size:])
