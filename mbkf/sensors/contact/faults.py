"""Faults of a plate over a whole trial, which a sample shows beside those around it.

=========  ========================================================================================================
spike      leaves by a jump faster than any foot's, and returns within :data:`SPIKE_S`
dropout    exact zeros that a loaded plate falls to, and rises from, within one sample
saturated  a channel stays at its largest value of the trial, as a converter's limit cuts a peak off
stuck      a loaded plate repeats the very same six numbers
sign       a plate that pulls where it should push
gain       a plate whose force lasts so long that it would throw the body
=========  ========================================================================================================

Impacts are real: the vertical force under a running foot rises by 100 to 300 body weights per second. A jump, however
steep, is a fault only if it is undone a sample or two later.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.numerics.runs import runs
from mbkf.sensors.contact.possible import MOST_WEIGHTS, Fault, Faults, all_possible, impossible

JUMP_WEIGHTS, JUMP_RATE = 0.5, 1000.0
"""Largest change of a foot's force from one sample to the next, in body weights and in body weights per second."""

JUMP_LEVER_M = 2.0
"""Largest lever at which a changing force changes a moment."""

SPIKE_S = 0.025
"""Longest spike; a longer jump is a change of the load."""

DROP_WEIGHTS, DROP_RATE = 0.25, 60.0
"""Least load that vanishes within one sample, in body weights and body weights per second. A foot leaves the floor with
some 20 to 40 of them per second; software zeroes a plate below 10 to 50 N."""

FLAT_SAMPLES, FLAT_S = 5, 0.005
"""Least number of equal samples, and duration, of a peak that is cut off: instruments have noise."""

FLAT_WEIGHTS, FLAT_LEVER_M = 0.2, 0.2
"""Least force of a cut-off peak, in body weights, and lever of the least moment; below, the plate was zeroed."""

STUCK_SAMPLES, STUCK_S = 20, 0.1
"""Least number of equal samples, and duration, of a plate that is stuck in all six channels. One that never changes, as
in a constructed example, is not stuck."""

STUCK_WEIGHTS = 0.05
"""Least force of a stuck plate, body weights; an unloaded one may read the same all the time."""

SIGN_S = 0.05
"""A plate has the wrong sign if it pulls impossibly for this long, and on the whole more than it pushes."""

BORNE_WEIGHTS, THROWN_M_S = 8.0, 15.0
"""A force beyond this many body weights accelerates the body; no contact adds more than this speed, that of a fall from
11 m."""

NO_FAULT = np.int8(Fault.NONE)


def faults_of(wrench: Array, rate_hz: float, weight_n: float, reach_m: float) -> Faults:
    """Fault of each sample of a trial.

    Args:
        wrench: (S, 6) force N and moment N m about the plate's origin, world axes.
        rate_hz: Sample rate.
        weight_n: The person's weight.
        reach_m: :func:`mbkf.sensors.contact.possible.reaches` of the plate.

    Returns:
        (S,) one :class:`Fault` per sample.
    """
    faults = np.zeros(len(wrench), dtype=np.int8)
    if not all_possible(wrench[:, None], weight_n, np.array([reach_m])):
        faults = impossible(wrench, weight_n, reach_m)
    if _pulls(wrench, faults, rate_hz, weight_n):
        return np.where(faults == Fault.NOT_A_NUMBER, faults, np.int8(Fault.SIGN))
    if _throws(wrench, rate_hz, weight_n):
        return np.where(faults == Fault.NOT_A_NUMBER, faults, np.int8(Fault.GAIN))
    for kind, found in (
        (Fault.STUCK, _stuck(wrench, faults, rate_hz, weight_n)),
        (Fault.SATURATED, _saturated(wrench, faults, rate_hz, weight_n)),
        (Fault.DROPOUT, _dropouts(wrench, faults, rate_hz, weight_n)),
    ):
        faults[found & (faults == NO_FAULT)] = kind
    spikes = _spikes(bridged(wrench, faults == Fault.NOT_A_NUMBER), rate_hz, weight_n)
    faults[spikes & (faults == NO_FAULT)] = Fault.SPIKE
    return faults


def bridged(wrench: Array, bad: BoolArray) -> Array:
    """Readings (S, 6) with straight lines over bad samples (S,), constant at either end; zero if all are bad."""
    if not bad.any():
        return wrench
    good, filled = np.flatnonzero(~bad), wrench.copy()
    gaps = np.flatnonzero(bad)
    for channel in filled.T:
        channel[gaps] = np.interp(gaps, good, channel[good]) if len(good) else 0.0
    return filled


def _pulls(wrench: Array, faults: Faults, rate_hz: float, weight_n: float) -> bool:
    """True if a plate pulls for some time, and more than it pushes."""
    pulling = faults == Fault.PULL
    if pulling.sum() < max(1.0, SIGN_S * rate_hz):
        return False
    vertical = wrench[(faults != Fault.NOT_A_NUMBER) & (faults != Fault.FORCE), 2]
    loaded = np.abs(vertical) > STUCK_WEIGHTS * weight_n
    return bool(vertical[loaded].sum() < 0.0)


def _throws(wrench: Array, rate_hz: float, weight_n: float) -> bool:
    """True if a contact's force would throw the body: ∫ (F_z − 8 W) dt > 15 m/s · W/g."""
    vertical = np.clip(np.nan_to_num(wrench[:, 2]), 0.0, MOST_WEIGHTS * weight_n) / weight_n
    contacts = runs(vertical > STUCK_WEIGHTS)
    least = THROWN_M_S / GRAVITY_M_S2 * rate_hz
    return any((vertical[first:after] - BORNE_WEIGHTS).sum() > least for first, after in contacts)


def _equal(same: BoolArray, least: int) -> BoolArray:
    """(S,) runs of at least so many equal samples; ``same`` (S − 1,) compares each with the next."""
    found = np.zeros(len(same) + 1, dtype=bool)
    for first, last in runs(same):
        found[first : last + 1] = last + 1 - first >= least
    return found


def _never_changes(known: Array) -> bool:
    """True if known values (n, …) are all the same, as in a constructed example."""
    return bool((known[1:] == known[:-1]).all())


def _stuck(wrench: Array, faults: Faults, rate_hz: float, weight_n: float) -> BoolArray:
    same = (wrench[1:] == wrench[:-1]).all(axis=1)
    if not same.any() or _never_changes(wrench[faults == NO_FAULT]):
        return np.zeros(len(wrench), dtype=bool)
    loaded = np.linalg.norm(wrench[:, :3], axis=1) >= STUCK_WEIGHTS * weight_n
    return _equal(same & loaded[1:], max(STUCK_SAMPLES, round(STUCK_S * rate_hz)))


def _saturated(wrench: Array, faults: Faults, rate_hz: float, weight_n: float) -> BoolArray:
    cut = np.zeros(len(wrench), dtype=bool)
    known = faults == NO_FAULT
    least = FLAT_WEIGHTS * weight_n * np.repeat([1.0, FLAT_LEVER_M], 3)
    for channel, floor in zip(wrench.T, least, strict=True):
        if _never_changes(channel[known]):
            continue
        for limit in (channel[known].max(), channel[known].min()):
            if abs(limit) >= floor:
                at_limit = channel == limit
                cut |= _equal(at_limit[1:] & at_limit[:-1], max(FLAT_SAMPLES, round(FLAT_S * rate_hz)))
    return cut


def _dropouts(wrench: Array, faults: Faults, rate_hz: float, weight_n: float) -> BoolArray:
    dropped = np.zeros(len(wrench), dtype=bool)
    least = (DROP_WEIGHTS + DROP_RATE / rate_hz) * weight_n
    carries = (wrench[:, 2] >= least) & (faults == NO_FAULT)
    for first, after in runs((wrench == 0.0).all(axis=1)):
        if first > 0 and after < len(wrench) and carries[first - 1] and carries[after]:
            dropped[first:after] = True
    return dropped


def _spikes(wrench: Array, rate_hz: float, weight_n: float) -> BoolArray:
    """(S,) samples between a jump of finite readings (S, 6) and its return; a jump without return does not count."""
    spikes = np.zeros(len(wrench), dtype=bool)
    jump_n = (JUMP_WEIGHTS + JUMP_RATE / rate_hz) * weight_n
    scaled = wrench / (jump_n * np.repeat([1.0, JUMP_LEVER_M], 3))
    longest = max(1, round(SPIKE_S * rate_hz))
    back_at = 0
    for before in np.flatnonzero((np.abs(np.diff(scaled, axis=0)) > 1.0).any(axis=1)).tolist():
        if before < back_at:
            continue
        following = scaled[before + 1 : before + 2 + longest]
        back = (np.abs(following - scaled[before]) <= 1.0).all(axis=1)
        if back.any():
            back_at = before + 1 + int(np.argmax(back))
            spikes[before + 1 : back_at] = True
    return spikes
