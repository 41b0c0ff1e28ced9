"""The double pendulum once more, by Pinocchio: two slides and two hinges, against which the other one is checked.

Its joint coordinates are p = [x_0, y_0, θ_1, θ_2 − θ_1] = T z with a constant T, so that ṗ = T ż and p̈ = T z̈.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from benchmarks.double_pendulum.forced_bodies import PlainCoordinates
from benchmarks.double_pendulum.pendulum import EFFORTS, RESIDUALS, PendulumShape
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.model.forced_body import LinearAcceleration

FROM_ABSOLUTE = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -1.0, 1.0]]
)
"""T."""


class PinocchioPendulum(PlainCoordinates):
    """The body of :class:`~benchmarks.double_pendulum.pendulum.DoublePendulum`, with the same arguments and results."""

    nv = 4

    def __init__(self, shape: PendulumShape, residual: bool = True) -> None:
        self.shape, self.residual = shape, residual
        self.nu = len(EFFORTS) + len(RESIDUALS) * residual
        self.pin_model = _chain(shape)
        self._data = pin.Data(self.pin_model)
        self._back = np.linalg.inv(FROM_ABSOLUTE)
        self._loads = pin.StdVec_Force()
        for _ in range(self.pin_model.njoints):
            self._loads.append(pin.Force.Zero())

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(4,) z̈ by the articulated-body algorithm.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu,) forces.
        """
        tau, _ = self._loaded(q, u)
        p, rate = FROM_ABSOLUTE @ q, FROM_ABSOLUTE @ v
        found: Array = self._back @ pin.aba(self.pin_model, self._data, p, rate, tau, self._loads)
        return found

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its derivatives, M⁻¹ times those of what drives it.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu,) forces.
        """
        tau, turned = self._loaded(q, u)
        p, rate = FROM_ABSOLUTE @ q, FROM_ABSOLUTE @ v
        pin.computeABADerivatives(self.pin_model, self._data, p, rate, tau, self._loads)
        upper = np.triu(self._data.Minv)
        inverse = upper + np.triu(upper, 1).T
        # Pinocchio holds the plate's force fixed to bar 2; it stays where it points while bar 2 turns with θ_2.
        by_q = self._data.ddq_dq @ FROM_ABSOLUTE
        by_q[:, 3] += inverse @ self._plate_pull(p) @ turned
        by_v = self._data.ddq_dv @ FROM_ABSOLUTE
        a = self._back @ self._data.ddq
        return LinearAcceleration(
            a, self._back @ by_q, self._back @ by_v, self._back @ inverse @ self._drive(q)
        )

    def force_response(self, q: Array) -> Array:
        """(4, nu) M⁻¹ Bᵀ at coordinates q (4,)."""
        upper = np.triu(pin.computeMinverse(self.pin_model, self._data, FROM_ABSOLUTE @ q))
        found: Array = self._back @ (upper + np.triu(upper, 1).T) @ self._drive(q)
        return found

    def efforts(self, q: Array, v: Array, a: Array) -> Array:
        """(nu,) T_e that cause a motion without residual, by recursive Newton–Euler.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            a: (4,) acceleration.
        """
        rate, accelerated = FROM_ABSOLUTE @ v, FROM_ABSOLUTE @ a
        tau = pin.rnea(self.pin_model, self._data, FROM_ABSOLUTE @ q, rate, accelerated)
        found = np.zeros(self.nu)
        found[:4] = np.linalg.solve(self._drive(q)[:, :4], tau)
        return found

    def _loaded(self, q: Array, u: Array) -> tuple[Array, Array]:
        """(4,) torques of the joints; puts the plate's wrench on bar 2, and says how that turns with θ_2 (3,)."""
        two, (tau_1, fx, fy, moment), L = float(q[3]), u[:4].tolist(), self.shape.length_m
        c, s = np.cos(two), np.sin(two)
        local = np.array([c * fx + s * fy, c * fy - s * fx])
        # Point 2 lies L below the joint of bar 2 in the bar's own axes; (0, −L) × f = L f_x about z.
        wrench = pin.Force(np.array([*local, 0.0]), np.array([0.0, 0.0, moment + L * local[0]]))
        self._loads[self.pin_model.njoints - 1] = wrench
        tau = np.array([0.0, 0.0, 0.0, tau_1])
        if self.residual:
            tau[:3] = u[4:]
        swing = np.array([local[1], -local[0]])
        return tau, np.array([*swing, L * swing[0]])

    def _plate_pull(self, p: Array) -> Array:
        """(4, 3) how force and moment on bar 2, in its axes about its joint, drive p."""
        pin.computeJointJacobians(self.pin_model, self._data, p)
        last = self.pin_model.njoints - 1
        found: Array = pin.getJointJacobian(self.pin_model, self._data, last, pin.LOCAL)[[0, 1, 5]].T
        return found

    def _drive(self, q: Array) -> Array:
        """(4, nu) how T_e drives p."""
        two, L = float(q[3]), self.shape.length_m
        c, s = np.cos(two), np.sin(two)
        local = np.array([[c, s, 0.0], [-s, c, 0.0], [L * c, L * s, 1.0]])
        drive = np.zeros((4, self.nu))
        drive[3, 0] = 1.0
        drive[:, 1:4] = self._plate_pull(FROM_ABSOLUTE @ q) @ local
        if self.residual:
            drive[:3, 4:] = np.eye(3)
        return drive


def _chain(shape: PendulumShape) -> pin.Model:
    """Two slides without mass, then the bars, each hanging down from its hinge.

    Raises:
        InvalidInput: Pinocchio finds the model inconsistent.
    """
    model = pin.Model()
    model.gravity.linear = np.array([0.0, -shape.gravity_m_s2, 0.0])
    L, here = shape.length_m, pin.SE3.Identity()
    slide = model.addJoint(0, pin.JointModelPX(), here, "x_0")
    slide = model.addJoint(slide, pin.JointModelPY(), here, "y_0")
    below = pin.SE3(np.eye(3), np.array([0.0, -L, 0.0]))
    first = model.addJoint(slide, pin.JointModelRZ(), here, "theta_1")
    second = model.addJoint(first, pin.JointModelRZ(), below, "theta_2")
    for joint, mass in ((first, shape.mass_1_kg), (second, shape.mass_2_kg)):
        around = np.diag([1.0, 0.0, 1.0]) * mass * L**2 / 12.0
        bar = pin.Inertia(mass, np.array([0.0, -0.5 * L, 0.0]), around)
        model.appendBodyToJoint(joint, bar, here)
    if not model.check(pin.Data(model)):
        raise InvalidInput("Pinocchio finds the pendulum's chain inconsistent")
    return model
