"""A double pendulum in natural coordinates: a forced body, as the whole human model is.

After M. Pérez Soto, doctoral thesis, Universidade da Coruña, 2022, section 3.3.1, whose equation numbers are used here.

Two bars hinged together at point 1; point 0 is the free end of bar 1, point 2 that of bar 2, which the ground holds
with F_x, F_y and T_2 (the "plate"). τ_1 is the torque of the joint. Independent coordinates z = [x_0, y_0, θ_1, θ_2]
(thesis eq. 3.56), angles absolute, counter-clockwise from the downward vertical; x to the right, y up, m and rad.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import casadi as ca
import numpy as np

from benchmarks.double_pendulum.compiled import Compiled
from benchmarks.double_pendulum.forced_bodies import PlainCoordinates
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.model.forced_body import LinearAcceleration

EFFORTS = ("tau_1", "F_x", "F_y", "T_2")
"""Components of T_e (thesis eq. 3.58), N m, N, N, N m."""

RESIDUALS = ("R_x", "R_y", "R_theta_1")
"""Residual efforts, which act on x_0, y_0 and θ_1; they follow those of T_e where they are part of it."""

ROOT = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
"""The equations of motion that τ_1 does not enter: forces on the whole body, and its moments."""


@dataclass(frozen=True)
class PendulumShape:
    """Masses and lengths of the bars.

    Attributes:
        mass_1_kg, mass_2_kg: Masses of the uniform bars.
        length_m: Length L of each.
        gravity_m_s2: As the thesis rounds it.
    """

    mass_1_kg: float = 50.0
    mass_2_kg: float = 25.0
    length_m: float = 0.8
    gravity_m_s2: float = 9.81

    def __post_init__(self) -> None:
        for item in fields(self):
            if not getattr(self, item.name) > 0.0:
                raise InvalidInput(f"a pendulum's {item.name} must be positive")


@dataclass(frozen=True)
class PointReading:
    """Points of the bars: ``positions_m`` (2 M,) x, y of each, and their Jacobian (2 M, 4) by z."""

    positions_m: Array
    jacobian: Array


@dataclass(frozen=True)
class Inertial:
    """M z̈ − Q_g, the generalised forces of a motion: ``force`` (4,), and derivatives (4, 4) by z, ż and z̈."""

    force: Array
    by_q: Array
    by_v: Array
    by_a: Array


class DoublePendulum(PlainCoordinates):
    """Natural coordinates q̄ of the three points (thesis eq. 3.53), carried to z by q̄' = R ż; derivatives by CasADi.

    A :class:`mbkf.model.forced_body.ForcedBody`.

    Attributes:
        shape: The bars.
        residual: True where residual efforts are part of T_e.
        nv, nu: Degrees of freedom (4) and efforts (4, with residual 7).
    """

    nv = 4

    def __init__(self, shape: PendulumShape, residual: bool = True) -> None:
        self.shape, self.residual = shape, residual
        self.nu = len(EFFORTS) + len(RESIDUALS) * residual
        z, v, a = (ca.SX.sym(name, 4) for name in "zva")
        u = ca.SX.sym("u", self.nu)
        R, Bt = _velocity_matrix(z, shape), _effort_matrix(z, shape, residual)
        M_bar, Q_bar = _natural_inertia(shape), _natural_forces(shape)
        M = R.T @ M_bar @ R
        Q_g = R.T @ (Q_bar - M_bar @ ca.jtimes(R @ v, z, v))
        accelerated = ca.solve(M, Q_g + Bt @ u)
        given = M @ a - Q_g
        self._points = Compiled("points", [z], [_points(z, shape)])
        self._maps = Compiled("maps", [z], [R, M, Bt])
        self._accelerate = Compiled("acceleration", [z, v, u], [accelerated])
        slopes = [ca.jacobian(accelerated, x) for x in (z, v, u)]
        self._respond = Compiled("response", [z], [ca.solve(M, Bt)])
        self._linearise = Compiled("linearise", [z, v, u], [accelerated, *slopes])
        self._given = Compiled("inertial", [z, v, a], [given, *(ca.jacobian(given, x) for x in (z, v, a))])

    # Dynamics.

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(4,) z̈ = M⁻¹ (Q_g + Bᵀ T_e) (thesis eq. 3.38), M = Rᵀ M̄ R and Q_g = Rᵀ (Q̄ − M̄ Ṙ ż) (thesis eqs. 2.16, 2.17).

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu,) forces.
        """
        return self._accelerate(q, v, u)[0]

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its complete derivatives (thesis eqs. 3.42–3.50).

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu,) forces.
        """
        return LinearAcceleration(*self._linearise(q, v, u))

    def force_response(self, q: Array) -> Array:
        """(4, nu) M⁻¹ Bᵀ at coordinates q (4,)."""
        return self._respond(q)[0]

    def inertial(self, q: Array, v: Array, a: Array) -> Inertial:
        """M z̈ − Q_g of a motion with its derivatives; without residual, Bᵀ T_e equals it.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            a: (4,) acceleration.
        """
        return Inertial(*self._given(q, v, a))

    def efforts(self, q: Array, v: Array, a: Array) -> Array:
        """(nu,) T_e that cause a motion without residual, by inverse dynamics (thesis eq. 3.12).

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            a: (4,) acceleration.
        """
        found = np.zeros(self.nu)
        found[:4] = np.linalg.solve(self.effort_matrix(q)[:, :4], self.inertial(q, v, a).force)
        return found

    # Geometry.

    def points(self, q: Array) -> Array:
        """(6,) natural coordinates x_0, y_0, x_1, y_1, x_2, y_2 (thesis eq. 3.53)."""
        return self._points(q)[0]

    def velocity_matrix(self, q: Array) -> Array:
        """(6, 4) R of thesis eq. 3.57: velocities of the points are R ż."""
        return self._maps(q)[0]

    def mass_matrix(self, q: Array) -> Array:
        """(4, 4) M = Rᵀ M̄ R (thesis eq. 2.16)."""
        return self._maps(q)[1]

    def effort_matrix(self, q: Array) -> Array:
        """(4, nu) Bᵀ of thesis eq. 3.59, with the residual's columns behind where it is part of T_e."""
        return self._maps(q)[2]

    def on_bars(self, q: Array, share: Array, bar: Array) -> PointReading:
        """Points on the bars' axes.

        Args:
            q: (4,) z.
            share: (M,) distance from the bar's upper end (point 0 or 1) over L.
            bar: (M,) 1 or 2.
        """
        x0, y0, one, two = q.tolist()
        sines, cosines = np.sin([one, two]), np.cos([one, two])
        direction, turned = np.stack([sines, -cosines], axis=1), np.stack([cosines, sines], axis=1)
        along = self.shape.length_m * np.stack(
            [np.where(bar == 1, share, 1.0), np.where(bar == 1, 0.0, share)], axis=1
        )
        jacobian = np.zeros((len(share), 2, 4))
        jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1.0
        jacobian[:, :, 2:] = np.einsum("mb,bx->mxb", along, turned)
        return PointReading((np.array([x0, y0]) + along @ direction).ravel(), jacobian.reshape(-1, 4))


def _natural_inertia(shape: PendulumShape) -> ca.DM:
    """(6, 6) M̄ of thesis eq. 3.55, constant."""
    bar = np.array([[1.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 1.0 / 3.0]])
    M = np.zeros((3, 3))
    M[:2, :2] += shape.mass_1_kg * bar
    M[1:, 1:] += shape.mass_2_kg * bar
    return ca.DM(np.kron(M, np.eye(2)))


def _natural_forces(shape: PendulumShape) -> ca.DM:
    """(6,) Q̄ of thesis eq. 3.55: half of each bar's weight at each of its ends."""
    one, two = shape.mass_1_kg, shape.mass_2_kg
    return ca.DM(-0.5 * shape.gravity_m_s2 * np.array([0.0, one, 0.0, one + two, 0.0, two]))


def _points(z: ca.SX, shape: PendulumShape) -> ca.SX:
    x, y, one, two = ca.vertsplit(z)
    L = shape.length_m
    x1, y1 = x + L * ca.sin(one), y - L * ca.cos(one)
    return ca.vertcat(x, y, x1, y1, x1 + L * ca.sin(two), y1 - L * ca.cos(two))


def _velocity_matrix(z: ca.SX, shape: PendulumShape) -> ca.SX:
    """R of thesis eq. 3.57 as printed; a test holds it to be what the points' positions give."""
    L, (one, two) = shape.length_m, ca.vertsplit(z)[2:]
    c1, s1, c2, s2 = (L * f(angle) for angle in (one, two) for f in (ca.cos, ca.sin))
    return ca.vertcat(
        ca.horzcat(1, 0, 0, 0),
        ca.horzcat(0, 1, 0, 0),
        ca.horzcat(1, 0, c1, 0),
        ca.horzcat(0, 1, s1, 0),
        ca.horzcat(1, 0, c1, c2),
        ca.horzcat(0, 1, s1, s2),
    )


def _effort_matrix(z: ca.SX, shape: PendulumShape, residual: bool) -> ca.SX:
    """Bᵀ of thesis eq. 3.59."""
    L, (one, two) = shape.length_m, ca.vertsplit(z)[2:]
    Bt = ca.vertcat(
        ca.horzcat(0, 1, 0, 0),
        ca.horzcat(0, 0, 1, 0),
        ca.horzcat(-1, L * ca.cos(one), L * ca.sin(one), 0),
        ca.horzcat(1, L * ca.cos(two), L * ca.sin(two), 1),
    )
    return ca.horzcat(Bt, ca.DM(np.eye(4, 3))) if residual else Bt
