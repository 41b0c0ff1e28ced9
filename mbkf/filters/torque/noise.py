"""Process noise of the whole body's forces: independent as in the thesis, or correlated as Newton–Euler demands.

Consistent noise departs from thesis eq. 3.39, whose forces are Wiener processes that do not depend on each other.
Forces that follow free accelerations and loads change by δτ = M δa − Jᵀ δw, or by M δa alone where loads are taken off
("inertial"). Noise that is independent instead leaves a foot of 1e-3 kg m² with the difference of two moments of
many N m. Where the residual is itself part of the random walk ("torque"), it has to stay small: there (δa, δw) are
drawn on condition that the pelvis's six rows of δτ are the residual's own small noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.filters.torque.plant import ForcedState
from mbkf.filters.torque.settings import MASS_OF_TABLE_KG, TorqueSettings
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.layout import FEET, FOOT
from mbkf.numerics.discretisation import symmetric
from mbkf.numerics.forced_error import ForceDensity


@dataclass(frozen=True)
class Conditioned:
    """A Gaussian made to obey linear readings: ``shift`` (n,) of its mean and its new ``covariance`` (n, n)."""

    shift: Array
    covariance: Array


def condition(covariance: Array, rows: Array, variance: Array, missing: Array) -> Conditioned:
    """Conditions x ~ N(x̄, C) on readings y = A x + r with independent r.

    Args:
        covariance: (n, n) C.
        rows: (m, n) A.
        variance: (m,) of r, or (m, m) its covariance.
        missing: (m,) innovation y − A x̄.
    """
    carried = covariance @ rows.T
    S = rows @ carried + (np.diag(variance) if variance.ndim == 1 else variance)
    factor = scipy.linalg.cho_factor(S, check_finite=False)
    gain = scipy.linalg.cho_solve(factor, carried.T, check_finite=False).T
    return Conditioned(gain @ missing, symmetric(covariance - gain @ carried.T))


def residual_variance(settings: TorqueSettings, mass_kg: float) -> Array:
    """(6,) variance per second of the residual, world axes."""
    s = settings
    return _variance(s.residual_force_n, s.residual_vertical_force_n, s.residual_moment_nm, mass_kg)


def load_variance(settings: TorqueSettings, mass_kg: float) -> Array:
    """(12,) variance per second of the foot wrenches, forces in world axes."""
    s = settings
    return np.tile(_variance(s.load_force_n, s.load_vertical_force_n, s.load_moment_nm, mass_kg), 2)


def _variance(force_n: float, vertical_n: float | None, moment_nm: float, mass_kg: float) -> Array:
    """(6,) of horizontal forces, the vertical force (None: as they) and moments (thesis eq. 4.18)."""
    scale = mass_kg / MASS_OF_TABLE_KG
    force, moment = force_n * scale, moment_nm * scale
    vertical = force if vertical_n is None else vertical_n * scale
    return np.array([force**2, force**2, vertical**2, moment**2, moment**2, moment**2])


class ForceNoise:
    """Spectral density of the plant noise w̃ on (δq, δv, δT_e) (thesis eqs. 2.42, 2.46).

    Attributes:
        body: The body.
        settings: How much, and whether "consistent" or "independent".
    """

    def __init__(self, body: HumanDynamics, dt_s: float, settings: TorqueSettings) -> None:
        """Makes the noise of a body.

        Args:
            body: The body.
            dt_s: Time step.
            settings: Variances of the thesis's Table 4.3 or their replacements.
        """
        self.body, self.settings = body, settings
        mass = body.model.mass_kg
        toes = body.model.acceleration_sd if settings.toe_acceleration is None else settings.toe_acceleration
        self._toes = np.where(body.kinematic & ~body.fixed, toes, 0.0) ** 2 * dt_s
        jerk = settings.jerk_scale * body.model.acceleration_sd
        self._jerk = np.where(body.kinematic, 0.0, jerk**2)
        self._residual, self._load = residual_variance(settings, mass), load_variance(settings, mass)
        if body.loads_given:
            self._load = np.zeros(FEET)
        roles, ids = body.model.roles, {name: j.joint_id for name, j in body.model.joints.items()}
        # Segments in whose axes a force of unequal variances stands in the state.
        self._root = None if settings.residual_vertical_force_n is None else ids[roles.root]
        apart = settings.load_vertical_force_n is not None and body.wrench_frame == "foot"
        self._feet = tuple(ids[name] for name in roles.feet) if apart else ()
        self._independent = self._own() * (1.0 / dt_s if settings.per_frame else 1.0)

    def __call__(self, state: ForcedState) -> ForceDensity:
        """At a state."""
        independent = self.settings.noise == "independent"
        return ForceDensity(self._toes, self._apart(state) if independent else self._together(state))

    def _apart(self, state: ForcedState) -> Array:
        own = np.diag(self._independent)
        if self._root is not None:
            own[:3, :3] = self._turned(state.q, self._root, self._independent[:3])
        self._turn_loads(state.q, own[-FEET:, -FEET:], self._independent[-FEET:])
        return own

    def _together(self, state: ForcedState) -> Array:
        rows, jerk = self.body.force_rows(state.q), np.concatenate([self._jerk, self._load])
        if self.body.force_state != "torque" and not self._feet:
            return symmetric((rows * jerk) @ rows.T)
        free = np.diag(jerk)
        self._turn_loads(state.q, free[-FEET:, -FEET:], self._load)
        if self.body.force_state == "torque":
            residual = self._residual
            if self._root is not None:
                residual = np.diag(residual)
                residual[:3, :3] = self._turned(state.q, self._root, self._residual[:3])
            free = condition(free, rows[:6], residual, np.zeros(6)).covariance
        return symmetric(rows @ free @ rows.T)

    def _turn_loads(self, q: Array, loads: Array, variance: Array) -> None:
        """Turns the forces' part of (12, 12) ``loads`` in place into the feet's axes, where they stand in these."""
        for side, foot in enumerate(self._feet):
            force = slice(FOOT * side, FOOT * side + 3)
            loads[force, force] = self._turned(q, foot, variance[force])

    def _turned(self, q: Array, joint: int, variance: Array) -> Array:
        """(3, 3) covariance in the axes of a segment, of variances (3,) in world axes."""
        axes = self.body.model.placements(q)[0][joint]
        return symmetric(axes.T @ (variance[:, None] * axes))

    def _own(self) -> Array:
        """(nu,) the thesis's variances (Table 4.3)."""
        body, scale = self.body, self.body.model.mass_kg / MASS_OF_TABLE_KG
        legs = np.zeros(body.nv, dtype=bool)
        for name, joint in body.model.joints.items():
            legs[joint.v] = name.endswith(("thigh", "shank", "foot"))
        torque = scale * np.where(legs, self.settings.lower_torque_nm, self.settings.upper_torque_nm)
        variance = np.where(body.kinematic, 0.0, torque**2)
        variance[:6] = self._residual
        own = variance[body.torque_dofs]
        return own if body.loads_given else np.concatenate([own, self._load])
