"""Two sessions side by side: for each curve and measure the difference and its 95 % interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.session import TrialKind
from mbkf.io.subject import Subject
from mbkf.study.session.chosen import Chosen, chosen_curves
from mbkf.study.session.cycles import ANGLE, Key, SideCycles
from mbkf.study.session.means import Difference, Mean, difference_of, mean_of
from mbkf.study.session.records import Measure, MovementGroup, Session
from mbkf.trial.gait.curves import ROOT
from mbkf.trial.gait.cycles import POINTS


@dataclass(frozen=True)
class CurvePair:
    """A curve of one side in both sessions.

    Attributes:
        key: The quantity.
        side: 0 right, 1 left.
        unit: Of the values.
        before, after: The cycles and their means.
        difference: After less before.
    """

    key: Key
    side: int
    unit: str
    before: Chosen
    after: Chosen
    difference: Difference


@dataclass(frozen=True)
class MeasurePair:
    """A measure of one side ("r", "l" or "") in both sessions: means, and the difference with its interval."""

    name: str
    unit: str
    side: str
    before: Mean
    after: Mean
    difference: Difference


@dataclass(frozen=True)
class Comparison:
    """The gait of a kind in two sessions.

    Attributes:
        kind: Of the trials.
        curves: Curves that both have, loads only where both are measured or both estimated.
        measures: Spatiotemporal parameters that both have.
        same_body: Whether both were reconstructed with the same scaled person.
        conditions: Conditions of before and after; empty where not stated.
    """

    kind: TrialKind
    curves: tuple[CurvePair, ...]
    measures: tuple[MeasurePair, ...]
    same_body: bool
    conditions: tuple[str, str] = ("", "")


def compare(before: Session, after: Session) -> tuple[Comparison, ...]:
    """Differences between two sessions, for each kind and condition of gait that both have.

    Args:
        before: The earlier session.
        after: The later one.
    """
    same = is_same_body(before.subject, after.subject)
    pairs = ((before.gait(one.kind, one.condition), one) for one in after.gaits)
    return tuple(_compare(first, second, same) for first, second in pairs if first is not None)


def conditions_compared(session: Session) -> tuple[Comparison, ...]:
    """Differences between the conditions of one session: each against the first one of its kind of gait.

    Args:
        session: The session, one scaled person.
    """
    found = []
    for one in session.gaits:
        first = session.gait(one.kind)
        if first is not None and first is not one:
            found.append(_compare(first, one, same=True))
    return tuple(found)


def is_same_body(one: Subject, other: Subject) -> bool:
    """True for two persons scaled alike, to the last digit: errors of the body are then the same."""
    return dict(one.scale_factors) == dict(other.scale_factors) and [
        (m.name, *m.position_m) for m in one.markers
    ] == [(m.name, *m.position_m) for m in other.markers]


def _compare(before: MovementGroup, after: MovementGroup, same: bool) -> Comparison:
    curves = []
    for side in range(2):
        first, second = before.sides[side], after.sides[side]
        moved = postures_apart(first, second)
        for key in second.curves:
            if key not in first.curves or key.is_emg:  # electrodes were put on anew
                continue
            old, new = chosen_curves(first, key), chosen_curves(second, key)
            if old.mean is None or new.mean is None or old.estimated != new.estimated:
                continue
            apart = difference_of(new.mean, old.mean, same, moved)
            curves.append(CurvePair(key, side, second.curves[key].unit, old, new, apart))
    measures = measure_pairs(before.measures, after.measures)
    return Comparison(after.kind, tuple(curves), measures, same, (before.condition, after.condition))


def postures_apart(first: SideCycles, second: SideCycles) -> Array:
    """(101,) squared distance of two mean postures over their mean squared distance from the mean of each, both added.

    A posture is all angles of joints that both have. 0 where they are the same.

    Args:
        first: The cycles of a side.
        second: Those of another session.
    """
    keys = [
        key
        for key, curves in second.curves.items()
        if key.quantity == ANGLE and curves.unit == "deg" and not key.name.startswith(ROOT)
    ]
    known = [
        (chosen_curves(first, key).mean, chosen_curves(second, key).mean)
        for key in keys
        if key in first.curves
    ]
    apart, range_squared = np.zeros(POINTS), 0.0
    for one, other in known:
        if one is not None and other is not None:
            apart += (one.mean - other.mean) ** 2
            range_squared += float(one.mean.var() + other.mean.var())
    return np.asarray(apart / range_squared) if range_squared > 0.0 else apart


def measure_pairs(before: tuple[Measure, ...], after: tuple[Measure, ...]) -> tuple[MeasurePair, ...]:
    """Measures that both sessions have, by side.

    Args:
        before: Of the earlier session.
        after: Of the later one.
    """
    known = {one.name: one for one in before}
    found = []
    for new in after:
        old = known.get(new.name)
        if old is None:
            continue
        for side in new.values:
            first, second = measure_mean(old, side), measure_mean(new, side)
            if first is not None and second is not None:
                apart = difference_of(second, first, same_body=True)
                found.append(MeasurePair(new.name, new.unit, side, first, second, apart))
    return tuple(found)


def measure_mean(measure: Measure, side: str) -> Mean | None:
    """The mean of a measure on a side; None: every value is unknown.

    Args:
        measure: The measure.
        side: "r", "l" or "".
    """
    values = measure.values.get(side, np.empty(0))
    known = np.isfinite(values)
    if not known.any():
        return None
    names = [name for name, good in zip(measure.trials[side], known, strict=True) if good]
    column: Array = values[known][:, None]
    return mean_of(column, names, np.zeros_like(column), np.full_like(column, np.nan))


def by_curve(comparison: Comparison) -> Mapping[tuple[Key, int], CurvePair]:
    """The curves of a comparison by quantity and side."""
    return {(pair.key, pair.side): pair for pair in comparison.curves}
