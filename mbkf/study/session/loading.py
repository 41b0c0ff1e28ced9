"""The whole body under its loads: total force, path of the centre of mass, and flights, for jumps and squats."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel
from mbkf.numerics.runs import stretches

AIRBORNE_SHARE = 0.05
"""Below this share of body weight nothing bears the body."""

FLIGHT_S = 0.08
"""Shorter flights are noise."""

FALLING = 0.5
"""In flight the centre of mass falls with this share of gravity at least."""


@dataclass(frozen=True)
class BodyPath:
    """The body as one mass.

    Attributes:
        times_s: (T,) times.
        mass_kg: Its mass.
        centre_m: (T, 3) centre of mass, NaN where the body is not followed.
        velocity_m_s: (T, 3) its velocity.
        foot_n: (T, 2) vertical force on right and left foot.
        force_n: (T,) vertical force of all contacts.
        known: (T,) whether all loads are known.
    """

    times_s: Array
    mass_kg: float
    centre_m: Array
    velocity_m_s: Array
    foot_n: Array
    force_n: Array
    known: BoolArray


def body_path(r: Reconstruction) -> BodyPath:
    """The path of a reconstructed body's centre of mass and the forces on it."""
    model = HumanModel.of(r.subject)
    centre = np.full((r.frames, 3), np.nan)
    for t in np.flatnonzero(r.tracked):
        centre[t] = model.centre_of_mass(r.q[t])
    velocity = np.gradient(centre, r.times_s, axis=0) if r.frames > 1 else np.full_like(centre, np.nan)
    wrench = r.loads.wrench
    return BodyPath(
        r.times_s,
        r.subject.mass_kg,
        centre,
        velocity,
        r.foot_wrench[:, :, 2],
        wrench[:, :, 2].sum(axis=1),
        r.valid & r.tracked,
    )


def flights(path: BodyPath) -> list[Array]:
    """Frames of each flight: nothing bears the body and its centre of mass falls freely."""
    weight = path.mass_kg * GRAVITY_M_S2
    rate_hz = (len(path.times_s) - 1) / max(float(np.ptp(path.times_s)), 1e-9)
    found = []
    for run in stretches(path.force_n < AIRBORNE_SHARE * weight):
        height = path.centre_m[run, 2]
        if len(run) < max(FLIGHT_S * rate_hz, 4) or np.isnan(height).any():
            continue
        if 2.0 * np.polyfit(path.times_s[run] - path.times_s[run[0]], height, 2)[0] < -FALLING * GRAVITY_M_S2:
            found.append(run)
    return found
