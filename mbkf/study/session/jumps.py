"""Measures of a jump trial: height by flight time and by the centre of mass, contact times, forces, power.

Height from the time in the air t is g t²/8 (P. V. Komi and C. Bosco, Med. Sci. Sports 10, 1978, 261-265); it counts too
much where the legs are bent at landing. Height of the centre of mass is its highest place in the air less that at
standing before the jump. Power is vertical force times the vertical velocity of the centre of mass.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.results import Reconstruction
from mbkf.study.session.loading import BodyPath, body_path, flights
from mbkf.study.session.records import Measure

PUSH_S, LANDING_S = 1.0, 0.5
"""Longest push-off before take-off, and duration of the landing after touch-down."""

STANDING_M_S = 0.1
"""A centre of mass slower than this stands."""


def jump_measures(r: Reconstruction) -> tuple[Measure, ...]:
    """The measures of each jump of a trial; empty where both feet never leave the floor."""
    path = body_path(r)
    found = flights(path)
    if not found:
        return ()
    jumps = [_jump(path, run, found[k - 1] if k else None) for k, run in enumerate(found)]
    return tuple(
        Measure(name, unit, {"": np.array([jump[k] for jump in jumps])}, {"": (r.trial,) * len(jumps)})
        for k, (name, unit) in enumerate(_MEASURES)
    )


def _jump(path: BodyPath, run: Array, before: Array | None) -> tuple[float, ...]:
    """The numbers of one jump, in the order of :data:`_MEASURES`."""
    t, weight = path.times_s, path.mass_kg * GRAVITY_M_S2
    step = float(np.median(np.diff(t)))
    flight_s = float(t[run[-1]] - t[run[0]]) + step
    pushing = (t < t[run[0]]) & (
        t >= max(t[run[0]] - PUSH_S, t[before[-1]] if before is not None else -np.inf)
    )
    landing = (t > t[run[-1]]) & (t <= t[run[-1]] + LANDING_S)
    power = path.force_n * path.velocity_m_s[:, 2] / path.mass_kg
    contact_s = np.nan if before is None else float(t[run[0]] - t[before[-1]]) - step
    right = path.foot_n[pushing & path.known]
    share = 100.0 * right[:, 0].sum() / right.sum() if right.sum() > 0 else np.nan
    return (
        100.0 * GRAVITY_M_S2 * flight_s**2 / 8.0,
        100.0 * (_most(path.centre_m[run, 2]) - _standing_height(path, run[0])),
        flight_s,
        contact_s,
        _most(power[pushing & path.known]),
        _most(path.force_n[pushing & path.known]) / weight,
        _most(path.force_n[landing & path.known]) / weight,
        float(share),
    )


_MEASURES = (
    ("Height by flight time", "cm"), ("Height of the centre of mass", "cm"), ("Flight time", "s"),
    ("Contact time", "s"), ("Peak power", "W/kg"), ("Peak force, push-off", "BW"), ("Peak force, landing", "BW"),
    ("Share of the right leg, push-off", "%"),
)  # fmt: skip


def _standing_height(path: BodyPath, take_off: int) -> float:
    """Height of the centre of mass while standing before a jump: the median of slow frames, else the upper quartile."""
    before = path.centre_m[:take_off, 2]
    slow = np.abs(path.velocity_m_s[:take_off, 2]) < STANDING_M_S
    upright = (
        before[slow & (before > np.nanpercentile(before, 50.0))] if np.isfinite(before).any() else before[:0]
    )
    if len(upright):
        return float(np.median(upright))
    return float(np.nanpercentile(before, 75.0)) if np.isfinite(before).any() else np.nan


def _most(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else np.nan
