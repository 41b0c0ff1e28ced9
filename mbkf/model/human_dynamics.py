"""The whole body as a forced one: residual, joint torques and two foot wrenches move it.

Dofs that follow a kinematic plant (the toes, and what no marker shows) have a prescribed acceleration of 0, so that
a toe's mass moves with its foot and its stiff dynamics stay out.

After M. Pérez Soto, doctoral thesis, Universidade da Coruña, 2022, sections 3.2 and 4.1.4, called "the thesis" here.
T_e are the forces u, Bᵀ their effect on the degrees of freedom, Q_g gravity and velocity terms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import scipy.linalg

from mbkf.conventions import Array, BoolArray
from mbkf.errors import UnknownName
from mbkf.model.body import Body
from mbkf.model.compiled_forces import CompiledForces, Given
from mbkf.model.forced_body import ForcedBody, LinearAcceleration
from mbkf.model.layout import FEET, Layout
from mbkf.model.turning import Turning

WRENCH_FRAMES = ("ankle", "foot", "thesis")
"""Coordinates of a wrench state; the moment is in the foot's axes in each.

"ankle": force in world axes on the ankle. A turn of the foot changes nothing, a turn of the leg little.
"foot": force in the foot's axes on the ankle; a turn of the foot turns the whole load.
"thesis": force in world axes on the foot's centre of mass (section 4.1.4.1), below the ankle, where it topples the
foot. The default "ankle" departs from thesis eq. 4.11.
"""

GIVEN_FRAME = "world"
"""Coordinates of wrenches that are known inputs: force and moment about the world's origin, world axes, as plates read.
"""


ROOT = 6
"""Dofs of the pelvis, the first ones."""

FORCE_STATES = ("inertial", "torque")
"""Coordinates of residual and joint torques T_d in u, which stay constant between frames.

"torque": T_d itself, as in the thesis. A loaded leg is a column: under constant torques its errors grow at 50 to
100 per second, and every movement needs changes of torque that the plant did not expect.
"inertial": the part of it that accelerates, M z̈ = T_d + B_pᵀ T_p + Q_g; T_d follows by subtracting what loads,
gravity and velocity ask for. A limb then keeps its acceleration. Reactions and motion meet in the residual, which
is measured as nearly zero. Accelerations and T_e of a frame are the same either way; only the coordinate u differs.
"""


@dataclass(frozen=True)
class JointForces:
    """Residual and joint torques T_d (50,) of a state, with derivatives by q and v (50, nv) and by u (50, nu)."""

    torque: Array
    by_q: Array
    by_v: Array
    by_u: Array


class HumanDynamics(ForcedBody):
    """A body of :class:`Body` moved by u = [for residual and joint torques (50), right (6) and left wrench (6)].

    Attributes:
        model: The body.
        fixed: (nv,) dofs that do not move.
        kinematic: (nv,) dofs with prescribed acceleration: the toes and the fixed ones.
        torque_dofs: The dofs that u's first entries act on: the root's six, then the joints but for the toes.
        wrench_frame: Coordinates of u's wrenches, see :data:`WRENCH_FRAMES`.
        force_state: Coordinates of its first entries, see :data:`FORCE_STATES`.
        loads_given: The feet's wrenches are known inputs (thesis 3.2.3), not forces of the body.
        nv, nu: Degrees of freedom, forces (62 for the reference body, 50 with given loads).
        compiled: The same by the compiled kernel, where it knows the body's joints; else None.

    With given loads, arguments u of the methods are the forces followed by these, (nu + 12,), and derivatives by u are
    those by the forces alone.
    """

    def __init__(
        self,
        model: Body,
        fixed: BoolArray | None = None,
        wrench_frame: str = "ankle",
        force_state: str = "inertial",
        loads_given: bool = False,
    ) -> None:
        """A scaled body with the forces that move it.

        Args:
            model: The body.
            fixed: (nv,) dofs that do not move; none when None.
            wrench_frame: Coordinates of u's wrenches, one of :data:`WRENCH_FRAMES`.
            force_state: Coordinates of u's first entries, one of :data:`FORCE_STATES`.
            loads_given: The feet's wrenches are known inputs, in :data:`GIVEN_FRAME`.

        Raises:
            UnknownName: The wrench frame or force state does not exist.
        """
        if wrench_frame not in WRENCH_FRAMES:
            raise UnknownName("wrench frame", wrench_frame, WRENCH_FRAMES)
        if force_state not in FORCE_STATES:
            raise UnknownName("force state", force_state, FORCE_STATES)
        self.model, self.force_state, self.loads_given = model, force_state, loads_given
        self.wrench_frame = GIVEN_FRAME if loads_given else wrench_frame
        self.nv = model.nv
        toes = np.zeros(model.nv, dtype=bool)
        for name in model.roles.toes:
            toes[model.joint(name).v] = True
        self.fixed = np.zeros(model.nv, dtype=bool) if fixed is None else fixed
        self.kinematic = toes | self.fixed
        self.torque_dofs = np.flatnonzero(~toes)
        self.nu = len(self.torque_dofs) + (0 if loads_given else FEET)
        self._columns = Layout.forced(self.nv, self.nu)
        self._free = np.flatnonzero(~self.kinematic)
        self._foot_ids = [model.joint(name).joint_id for name in model.roles.feet]
        on_com = 1.0 if wrench_frame == "thesis" else 0.0
        self._points = [on_com * model.pin_model.inertias[k].lever for k in self._foot_ids]
        self._data = pin.Data(model.pin_model)
        self._weightless = model.pin_model.copy()
        self._weightless.gravity.linear = np.zeros(3)
        self._loads = pin.StdVec_Force([pin.Force.Zero()] * model.pin_model.njoints)
        # True where loads, gravity and velocity act on the accelerations; else u has subtracted them.
        self._acting = force_state == "torque"
        self._selector = np.zeros((model.nv, len(self.torque_dofs)))
        self._selector[self.torque_dofs, np.arange(len(self.torque_dofs))] = 1.0
        self._turning = Turning.of(model)
        self.compiled = CompiledForces.where_built(
            model, ~self.kinematic, np.array(self._points), self.wrench_frame
        )

    # The manifold.

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nq,) configuration q ⊕ dv."""
        return self.model.integrate(q, dv)

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) the tangent vector from q0 to q1."""
        return self.model.difference(q0, q1)

    def retraction(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """Derivatives (nv, nv) of q ⊕ dv by q and by dv."""
        return self.model.integration_derivatives(q, dv)

    def transport(self, v: Array) -> Array:
        """(nv, nv) −ad(v) of each joint: δ̇ = −v × δ + δv for errors in the joints' own axes.

        Departs from thesis eq. 3.40, which has 0 here: its coordinates are a flat space.
        """
        return self._turning.at(v)

    # Forces.

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(nv,) M⁻¹ (Q_g + Bᵀ T_e) of the free dofs, 0 of the kinematic ones."""
        dofs = len(self.torque_dofs)
        push = np.zeros(self.nv)
        push[self.torque_dofs] = u[:dofs]
        if self._acting:
            push += self._force(q, v, u[dofs:])
        return self._accelerate(q, push)

    def force_response(self, q: Array) -> Array:
        """(nv, nu) ∂z̈/∂T_e = M⁻¹ Bᵀ alone, all that the simplified F has of the dynamics (thesis eq. 4.15)."""
        dofs, found = len(self.torque_dofs), np.zeros((self.nv, self.nu), order="F")
        acting = self._acting and not self.loads_given
        if self.compiled is not None:
            inverse = self.compiled.mass(q)[1]
            found[:, :dofs] = inverse[:, self.torque_dofs]
            if acting:
                found[:, dofs:] = inverse @ self._load_by_state(q)
            return found
        right = np.zeros((self.nv, self.nu))
        right[:, :dofs] = self._selector
        if acting:
            right[:, dofs:] = self._load_by_state(q)
        found[self._free] = scipy.linalg.cho_solve(self._factor(q), right[self._free], check_finite=False)
        return found

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its complete analytic derivatives.

        ∂z̈/∂q = M⁻¹ (∂(Bᵀ T_e + Q_g)/∂q − ∂(M a)/∂q), a constant in the last term. Departs from thesis eq. 3.48, whose
        2Ṙ holds for velocities of points and not for angular velocities, by differentiating Newton–Euler itself.
        """
        nv, rows, dofs = self.nv, self._free, len(self.torque_dofs)
        given = self._given(q, v, u[dofs:]) if self._acting else Given.nothing(nv)
        push = given.force.copy()
        push[self.torque_dofs] += u[:dofs]
        a = self._accelerate(q, push)
        right = given.by_q - self._inertia_slope(q, a)
        if self.compiled is not None:
            inverse, by_u = self.compiled.mass(q)[1], np.zeros((nv, self.nu), order="F")
            by_u[:, :dofs] = inverse[:, self.torque_dofs]
            if not self._acting:
                return LinearAcceleration(a, inverse @ right, given.by_v, by_u)
            if not self.loads_given:
                by_u[:, dofs:] = inverse @ given.by_state
            return LinearAcceleration(a, inverse @ right, inverse @ given.by_v, by_u)
        by_forces = [self._selector] if self.loads_given else [self._selector, given.by_state]
        right = np.concatenate([right, given.by_v, *by_forces], axis=1)
        slope = np.zeros((nv, right.shape[1]))
        slope[rows] = scipy.linalg.cho_solve(self._factor(q), right[rows], check_finite=False)
        columns = self._columns
        return LinearAcceleration(a, slope[:, columns.q], slope[:, columns.v], slope[:, columns["u"]])

    def forces(self, q: Array, v: Array, a: Array, foot_wrench: Array) -> Array:
        """(nu,) forces u that cause a motion under these reactions, by inverse dynamics.

        Args:
            q: Configuration.
            v: Velocity.
            a: (nv,) acceleration.
            foot_wrench: (2, 6) force N and moment N m about the world's origin on right and left foot.
        """
        state = self.wrench_state(q, foot_wrench)
        u = self.mass(q) @ a
        if self._acting:
            u -= self._force(q, v, state)
        return u[self.torque_dofs] if self.loads_given else np.concatenate([u[self.torque_dofs], state])

    def generalised(self, q: Array, v: Array, a: Array, u: Array) -> Array:
        """(nv,) generalised forces M a − Q_g − Jᵀ w of all dofs, kinematic ones too, under u's wrenches.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            u: (nu,) forces.
        """
        return self.mass(q) @ a - self._force(q, v, u[len(self.torque_dofs) :])

    def joint_forces(self, q: Array, v: Array, u: Array) -> JointForces:
        """Residual and joint torques T_d of a state.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """
        dofs, nv = len(self.torque_dofs), self.nv
        if self._acting:
            none = np.zeros((dofs, nv))
            return JointForces(u[:dofs].copy(), none, none, np.eye(dofs, self.nu))
        given = self._given(q, v, u[dofs:])
        by_u = np.eye(dofs, self.nu)
        if not self.loads_given:
            by_u[:, dofs:] = -given.by_state[self.torque_dofs]
        rows = self.torque_dofs
        return JointForces(u[:dofs] - given.force[rows], -given.by_q[rows], -given.by_v[rows], by_u)

    def residual(self, q: Array, v: Array, u: Array) -> JointForces:
        """The pelvis's six of :meth:`joint_forces`.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """
        if self._acting or self.compiled is None:
            every = self.joint_forces(q, v, u)
            return JointForces(every.torque[:ROOT], every.by_q[:ROOT], every.by_v[:ROOT], every.by_u[:ROOT])
        dofs = len(self.torque_dofs)
        given, by_u = self.compiled.at_root(q, v, u[dofs:]), np.eye(ROOT, self.nu)
        if not self.loads_given:
            by_u[:, dofs:] = -given.by_state
        return JointForces(u[:ROOT] - given.force, -given.by_q, -given.by_v, by_u)

    def mass(self, q: Array) -> Array:
        """(nv, nv) symmetric mass matrix."""
        return self.model.mass_matrix(q) if self.compiled is None else self.compiled.mass(q)[0]

    def force_rows(self, q: Array) -> Array:
        """(nu, nv + 12) derivative of u by accelerations and wrench states, δu = rows (δa, δw)."""
        dofs = len(self.torque_dofs)
        rows = np.zeros((self.nu, self.nv + FEET))
        rows[:dofs, : self.nv] = self.mass(q)[self.torque_dofs]
        if self._acting:
            rows[:dofs, self.nv :] = -self._load_by_state(q)[self.torque_dofs]
        if not self.loads_given:
            rows[dofs:, self.nv :] = np.eye(FEET)
        return rows

    # Wrenches.

    def wrench_state(self, q: Array, foot_wrench: Array) -> Array:
        """(12,) u's wrenches from those (2, 6) about the world's origin in world axes."""
        if self.loads_given:
            return foot_wrench.reshape(FEET)
        pin.forwardKinematics(self.model.pin_model, self._data, q)
        state = np.empty(FEET)
        for side, (joint, point) in enumerate(zip(self._foot_ids, self._points, strict=True)):
            place = self._data.oMi[joint]
            force, moment = foot_wrench[side, :3], foot_wrench[side, 3:]
            local = place.rotation.T @ (moment - np.cross(place.translation, force))
            turned = place.rotation.T @ force
            if self.wrench_frame == "foot":
                state[6 * side : 6 * side + 6] = np.concatenate([turned, local])
            else:
                state[6 * side : 6 * side + 6] = np.concatenate([force, local - np.cross(point, turned)])
        return state

    def local_wrench(self, q: Array, state: Array) -> tuple[Array, Array, Array]:
        """(12,) wrenches in the feet's axes about the ankles, and derivatives by state (12, 12) and q (12, nv)."""
        pin.computeJointJacobians(self.model.pin_model, self._data, q)
        return self._local(state)

    def _local(self, state: Array) -> tuple[Array, Array, Array]:
        if self.wrench_frame == "foot":
            return state, np.eye(FEET), np.zeros((FEET, self.nv))
        local, by_state, by_q = np.empty(FEET), np.zeros((FEET, FEET)), np.zeros((FEET, self.nv))
        jacobians = self._foot_jacobians()
        turns = [jacobian[3:] for jacobian in jacobians]
        for side, (joint, point) in enumerate(zip(self._foot_ids, self._points, strict=True)):
            at, force, moment = 6 * side, slice(6 * side, 6 * side + 3), slice(6 * side + 3, 6 * side + 6)
            back = self._data.oMi[joint].rotation.T
            turned = back @ state[force]
            if self.loads_given:
                arm = pin.skew(self._data.oMi[joint].translation)
                local[force], local[moment] = turned, back @ (state[moment] - arm @ state[force])
                by_state[force, force] = by_state[moment, moment] = back
                by_state[moment, force] = -back @ arm
                shifted = pin.skew(turned) @ jacobians[side][:3]
                swing = [pin.skew(local[part]) @ turns[side] for part in (force, moment)]
                by_q[at : at + 6] = np.concatenate([swing[0], swing[1] + shifted])
                continue
            local[force], local[moment] = turned, state[moment] + np.cross(point, turned)
            by_state[force, force], by_state[moment, moment] = back, np.eye(3)
            by_state[moment, force] = pin.skew(point) @ back
            swing = pin.skew(turned) @ turns[side]
            by_q[at : at + 6] = np.concatenate([swing, pin.skew(point) @ swing])
        return local, by_state, by_q

    def _foot_jacobians(self) -> list[Array]:
        """(6, nv) of each ankle in the foot's axes, after the joint Jacobians were computed."""
        model = self.model.pin_model
        return [pin.getJointJacobian(model, self._data, joint, pin.LOCAL) for joint in self._foot_ids]

    def _pull(self) -> Array:
        """(nv, 12) Jᵀ from wrenches in the feet's axes to generalised forces, likewise."""
        return np.concatenate(self._foot_jacobians(), axis=0).T

    def _load_by_state(self, q: Array) -> Array:
        """(nv, 12) derivative of the generalised forces by the wrench states, which they are linear in."""
        if self.compiled is not None:
            return self.compiled.pull(q)
        _, by_state, _ = self.local_wrench(q, np.zeros(FEET))
        return self._pull() @ by_state

    def _force(self, q: Array, v: Array, state: Array) -> Array:
        """(nv,) generalised forces of wrench states, gravity and velocity on all dofs."""
        if self.compiled is not None:
            return self.compiled.force(q, v, state)
        local = self.local_wrench(q, state)[0]
        return self._pull() @ local - pin.nonLinearEffects(self.model.pin_model, self._data, q, v)

    def _given(self, q: Array, v: Array, state: Array) -> Given:
        """:meth:`_force` with derivatives."""
        if self.compiled is not None:
            return self.compiled.given(q, v, state)
        model, still = self.model.pin_model, np.zeros(self.nv)
        local, by_state, by_q = self.local_wrench(q, state)
        pull = self._pull()
        for side, joint in enumerate(self._foot_ids):
            self._loads[joint] = pin.Force(local[6 * side : 6 * side + 6])
        force = -pin.rnea(model, self._data, q, v, still, self._loads)
        # Pinocchio's derivative includes how the pull of a wrench constant in the foot's axes changes with q.
        bias_q, bias_v, _ = pin.computeRNEADerivatives(model, self._data, q, v, still, self._loads)
        return Given(force, pull @ by_q - bias_q, -bias_v, pull @ by_state)

    def _inertia_slope(self, q: Array, a: Array) -> Array:
        """(nv, nv) ∂(M a)/∂q."""
        if self.compiled is not None:
            return self.compiled.inertia_slope(q, a)
        return pin.computeRNEADerivatives(self._weightless, self._data, q, np.zeros(self.nv), a)[0]

    def _accelerate(self, q: Array, push: Array) -> Array:
        """(nv,) acceleration of the free dofs under generalised forces."""
        if self.compiled is not None:
            return self.compiled.mass(q)[1] @ push
        a = np.zeros(self.nv)
        a[self._free] = scipy.linalg.cho_solve(self._factor(q), push[self._free], check_finite=False)
        return a

    def _factor(self, q: Array) -> tuple[Array, bool]:
        """Cholesky factor of the free dofs' mass matrix."""
        rows = self._free
        upper = pin.crba(self.model.pin_model, self._data, q)[np.ix_(rows, rows)]
        return scipy.linalg.cho_factor(upper, lower=False, check_finite=False)
