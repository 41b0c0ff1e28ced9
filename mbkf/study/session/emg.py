"""Electromyograms by gait cycle: envelopes and activity of each muscle, and their amplitude over a reference.

The amplitude depends on skin and electrodes, so that it is shown in per cent (A. Burden, J. Electromyogr. Kinesiol. 20
(2010) 1023-1035): of the largest envelope in the session's cycles, of their mean, or of the largest in a trial that was
made for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.io.results import Reconstruction
from mbkf.study.session.cycles import EMG, EMG_ACTIVE, Curves, Key, SideCycles
from mbkf.study.session.records import MovementGroup, Session, TrialEmg
from mbkf.trial.emg.settings import EmgSettings
from mbkf.trial.gait.curves import ENDINGS
from mbkf.trial.gait.cycles import POINTS, Cycle, over_cycle

PEAK, MEAN = "peak", "mean"
"""References of an amplitude besides a trial's name."""

ACTIVE_SHARE = 0.5
"""A muscle is shown as active where it is so in this share of the cycles or more."""


def with_emg(r: Reconstruction, side: SideCycles) -> SideCycles:
    """The cycles of a side with the envelopes and the activity of its muscles, and of those without a side.

    Args:
        r: The trial's results.
        side: Its cycles.
    """
    if r.emg_envelope is None or not side.cycles:
        return side
    cycles = [one.cycle for one in side.cycles]
    curves = dict(side.curves)
    for k, name in enumerate(r.muscle_names):
        if name.endswith(ENDINGS[1 - side.side]):
            continue
        own = name.removesuffix(ENDINGS[side.side])
        values = np.array([over_cycle(r.times_s, r.emg_envelope[:, k], cycle) for cycle in cycles])
        active = np.array([_active(r, name, cycle) for cycle in cycles])
        for key, unit, found in ((Key(EMG, own), "V", values), (Key(EMG_ACTIVE, own), "1", active)):
            unknown = np.full_like(found, np.nan)
            curves[key] = Curves(unit, found, unknown, unknown, unknown)
    return replace(side, curves=curves)


def _active(r: Reconstruction, name: str, cycle: Cycle) -> Array:
    """(101,) 1 where a muscle is active, else 0."""
    at = np.linspace(cycle.start_s, cycle.end_s, POINTS)
    active = np.zeros(POINTS)
    for one in r.muscle_bursts:
        if one.muscle == name:
            active[(at >= one.from_s) & (at <= one.to_s)] = 1.0
    return active


def trial_emg(r: Reconstruction) -> TrialEmg | None:
    """The electromyograms of a trial in short; None without."""
    if r.emg_envelope is None:
        return None
    peaks = {name: float(np.nanmax(r.emg_envelope[:, k])) for k, name in enumerate(r.muscle_names)}
    known = {one.name for one in fields(EmgSettings)}
    stated = r.settings.get("emg")
    own = {key: value for key, value in stated.items() if key in known} if isinstance(stated, Mapping) else {}
    return TrialEmg(peaks, EmgSettings(**own), r.emg_rate_hz)


@dataclass(frozen=True)
class MuscleCycles:
    """A muscle of one side over the session's cycles.

    Attributes:
        side: 0 right, 1 left.
        percent: (C, 101) envelopes in per cent of the reference; NaN in cycles of trials without the muscle.
        active_share: (101,) share of the cycles in which the muscle is active.
    """

    side: int
    percent: Array
    active_share: Array


def muscles(gait: MovementGroup) -> tuple[str, ...]:
    """Names of the muscles of a gait without their side, in order of the channels."""
    return tuple(dict.fromkeys(key.name for side in gait.sides for key in side.curves if key.quantity == EMG))


def muscle_cycles(
    session: Session, gait: MovementGroup, name: str, reference: str
) -> tuple[MuscleCycles, ...]:
    """The cycles of a muscle on the sides that have it.

    Args:
        session: The session, for its trials.
        gait: One of its gaits.
        name: The muscle without its side.
        reference: :data:`PEAK` or :data:`MEAN` of the cycles, or the name of a trial.

    Raises:
        UnknownName: The session has no such trial with electromyograms.
    """
    found = []
    for side in gait.sides:
        curves = side.curves.get(Key(EMG, name))
        if curves is None:
            continue
        known = np.isfinite(curves.values).all(axis=1)
        if not known.any():
            continue
        over = _reference(session, name, side.side, curves.values[known], reference)
        if over is not None and over > 0.0:
            active = side.curves[Key(EMG_ACTIVE, name)].values[known].mean(axis=0)
            found.append(MuscleCycles(side.side, 100.0 * curves.values / over, active))
    return tuple(found)


def _reference(session: Session, name: str, side: int, values: Array, reference: str) -> float | None:
    """100 % in V; None where the reference trial lacks the muscle."""
    if reference in (PEAK, MEAN):
        return float(values.max() if reference == PEAK else values.mean())
    trials = {one.name: one.emg.peaks_v for one in session.trials if one.emg is not None}
    if reference not in trials:
        raise UnknownName("reference trial with EMG", reference, (PEAK, MEAN, *trials))
    peaks = trials[reference]
    return peaks.get(name + ENDINGS[side], peaks.get(name))
