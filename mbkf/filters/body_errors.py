"""Error of an estimate caused by errors of the person's scaled body: the part that repeats.

Scaling leaves scale factors, marker places and displacements of the skin by flexion, together p, with a covariance
Σ = L Lᵀ. A filter takes them for known. In a posture q, markers that are weighed with R, beside a prior of information
Π, then put the pose wrong by

    δq = W δp,   W = −(Hᵀ R⁻¹ H + Π)⁻¹ Hᵀ R⁻¹ H_p,

H and H_p the derivatives of marker positions by q and p. These are consider parameters (S. F. Schmidt 1966): never
estimated, their share of the error is carried along. So is the posture that a person holds otherwise than the prior has
it (:mod:`mbkf.filters.pose_errors`). Pose errors that hold whenever the posture is the same change while the body
moves, so velocities and accelerations err by the rates of W δp along the motion. Generalised forces τ(x, k) err by
∂τ/∂x δx + ∂τ/∂k δk, and by segment masses and centres of mass (:mod:`mbkf.filters.inertia_errors`).

All is kept as B = (∂·/∂p) L, so that a covariance is B Bᵀ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.inertia_errors import InertiaErrors
from mbkf.filters.pose_errors import PoseErrors
from mbkf.filters.section_errors import SectionErrors
from mbkf.model.body import Body
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import ROOT, JointTorques, NewtonEuler
from mbkf.numerics.principal import of_unit_length, principal_directions
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor

LOOK_S = 0.02
"""Half the stretch of the motion over which rates of pose errors are taken, s."""

TURN_S = 1e-4
"""Step of the difference quotient by time, s."""

SIZE_STEP = 1e-4
"""Step of the difference quotients by scale factors and joint centres, the latter in m."""

KEPT_OF_SIZES = 0.98
"""Share of the variance of factors and joint centres whose own effect on torques is kept."""

POSTURES, POSTURE_RAD = 10, 0.4
"""Errors by the body are compared in so many postures, joints turned from neutral by such angles (1 sd)."""

KEPT_VARIANCE = 0.99
"""Share of the variance kept: half of the columns of L move no joint."""


@dataclass(frozen=True)
class BodyErrorRoots:
    """Roots B of errors by the body at one instant; B Bᵀ is the covariance of each.

    Those of the motion have nv rows and r columns. Those of loads have k further columns: segment masses and centres
    of mass change no motion.

    Attributes:
        position: Of the configuration, in its tangent space.
        velocity: Of the velocity.
        torque: (nv, r + k) of the generalised forces.
        wrench: (12, r + k) of the feet's wrenches; 0 for a foot whose plate reads it.
        sections: Works out :attr:`level`; None where it is not known.
    """

    position: Array
    velocity: Array
    torque: Array
    wrench: Array
    sections: Callable[[], Array] | None = field(default=None, repr=False, compare=False)

    @cached_property
    def level_variance(self) -> Array | None:
        """(2, L, 3) of the trunk's moments by way and level; None where they are not known."""
        if self.sections is None:
            return None
        root = self.sections()
        return np.asarray(np.einsum("wlij,wlij->wli", root, root))

    @cached_property
    def position_variance(self) -> Array:
        """(nv,) of the configuration."""
        return _squared(self.position)

    @cached_property
    def velocity_variance(self) -> Array:
        """(nv,) of the velocity."""
        return _squared(self.velocity)

    @cached_property
    def torque_variance(self) -> Array:
        """(nv,) of the generalised forces."""
        return _squared(self.torque)

    @cached_property
    def wrench_variance(self) -> Array:
        """(2, 6) of the feet's wrenches."""
        return _squared(self.wrench).reshape(2, 6)

    def blocks(self, dofs: NDArray[np.intp]) -> tuple[Array, Array]:
        """(b, 3, 3) covariances of configuration and velocity, of the same three dofs (b, 3) whenever it is asked."""
        if not self._blocks:
            for root in (self.position, self.velocity):
                own = root[dofs]
                self._blocks.append(own @ own.transpose(0, 2, 1))
        position, velocity = self._blocks
        return position, velocity

    _blocks: list[Array] = field(default_factory=list, init=False, repr=False, compare=False)


def _squared(root: Array) -> Array:
    """(n,) squared sums of rows."""
    return np.asarray(np.einsum("ij,ij->i", root, root))


class BodyErrors:
    """Errors by the body, for the markers of a trial.

    Attributes:
        sensor: The markers on the body.
    """

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        root: Array,
        skin: FlexedSkin | None = None,
        held_rad: Array | None = None,
        posture_sd_rad: Array | None = None,
    ) -> None:
        """Makes it.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) standard deviation that the filter weighs each marker with, m.
            root: (K + E + 3 M (1 + D), r) L of the covariance of scale factors, displacements of joint centres, marker
                places and displacements by flexion.
            skin: Shares of these displacements; None where no skin is known (D = 0).
            held_rad: (nv,) standard deviation of the rotation from neutral in which a person holds a joint, rad; 0 by
                default.
            posture_sd_rad: (nv,) spread of the prior that draws joints to neutral; by default the body's table.
        """
        model = sensor.model
        self.sensor, self._model, self._balance = sensor, model, NewtonEuler(model)
        self._poses = PoseErrors(sensor, noise_m, root, skin, held_rad, posture_sd_rad)
        self._poses.onto(self._directions())
        directions = principal_directions(self._poses.sizes.T, KEPT_OF_SIZES)
        self._along = directions.T @ self._poses.sizes
        self._varied = [NewtonEuler(one) for one in _varied(model, directions.T)]
        self._inertia = InertiaErrors(model)

    @cached_property
    def _sections(self) -> SectionErrors:
        varied = [balance.model for balance in self._varied]
        return SectionErrors(self._model, varied, self._along / SIZE_STEP, self._inertia)

    def _directions(self) -> Array:
        """(r, n) orthonormal directions of L's columns in which nearly all of every dof's variance lies."""
        model, rng = self._model, np.random.default_rng(0)
        turned = POSTURE_RAD * rng.normal(size=(POSTURES, model.nv))
        turned[:, :ROOT] = 0.0
        poses = np.array([model.integrate(model.neutral(), moved) for moved in turned])
        stacked = np.concatenate([self._poses.sizes, *self.pose_roots(poses)])
        return principal_directions(of_unit_length(stacked), KEPT_VARIANCE)

    def pose_root(self, q: Array) -> Array:
        """(nv, r) W L at a configuration q (nq,).

        Raises:
            numpy.linalg.LinAlgError: Markers and posture do not determine the pose.
        """
        return self.pose_roots(q[None])[0]

    def pose_roots(self, poses: Array) -> list[Array]:
        """Roots (nv, r) of :meth:`pose_root`, one for each of the configurations (N, nq)."""
        return self._poses.roots(poses)

    def at(
        self, q: Array, v: Array, a: Array, wrenches: Array, contact: tuple[int, int] | None
    ) -> BodyErrorRoots:
        """Roots of all errors by the body at an estimate.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            wrenches: (2, 6) right and left foot's wrenches about the world's origin; NaN where unknown.
            contact: What the feet stand on (:class:`mbkf.sensors.contact.records.Contact`); None where not decided.
        """
        model, h = self._model, LOOK_S
        steps = (h * v + 0.5 * h * h * a, -h * v + 0.5 * h * h * a)
        poses = [q, *(model.integrate(q, step) for step in steps)]
        here, *around = self.pose_roots(np.array(poses))
        for n, step in enumerate(steps):
            back, _ = model.integration_derivatives(poses[n + 1], -step)
            around[n] = back @ around[n]
        velocity = (around[0] - around[1]) / (2.0 * h)
        # The dofs' own axes turn while the error changes, at this rate.
        turned, _ = model.integration_derivatives(q, TURN_S * v)
        rate = (turned - np.eye(model.nv)) / TURN_S
        loads = np.nan_to_num(wrenches).ravel()
        balance = self._balance.torques(q, v, a, loads)
        residual, residual_slope = balance.tau[:ROOT].copy(), balance.by_state[:ROOT].copy()
        # The acceleration errs by (around₀ − 2 here + around₁) / h² + rate @ velocity.
        by_q, by_v = balance.by_q - (2.0 / h**2) * balance.by_a, balance.by_v + balance.by_a @ rate
        torque = by_q @ here + by_v @ velocity + balance.by_a @ ((around[0] + around[1]) / h**2)
        torque += self._own_torques(q, v, a, loads, balance)
        torque = np.hstack([torque, self._inertia.at(q, v, a)])
        wrench = self._unread(balance, torque[:ROOT], loads, contact)
        torque += balance.by_wrench @ wrench

        def sections() -> Array:
            acceleration = (around[0] - 2.0 * here + around[1]) / h**2 + rate @ velocity
            motion = np.vstack([here, velocity, acceleration])
            return self._sections.at((q, v, a), motion, torque[:ROOT], (residual, residual_slope))

        return BodyErrorRoots(here, velocity, torque, wrench, sections)

    def _own_torques(self, q: Array, v: Array, a: Array, loads: Array, balance: JointTorques) -> Array:
        """(nv, r) of the generalised forces by factors and joint centres themselves, at a motion that is known.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            loads: (12,) the feet's wrenches.
            balance: The equations at them.
        """
        by_size = np.array([one.tau(q, v, a, loads) - balance.tau for one in self._varied]).T / SIZE_STEP
        return np.asarray(by_size @ self._along)

    def _unread(
        self, balance: JointTorques, residual: Array, loads: Array, contact: tuple[int, int] | None
    ) -> Array:
        """(12, r) of the wrenches that no plate reads: Newton's law holds at the root with the errors of the motion.

        Args:
            balance: The equations.
            residual: (6, r) root of the law's residual with wrenches as they are.
            loads: (12,) the wrenches.
            contact: What the feet stand on.
        """
        found = np.zeros((12, residual.shape[1]))
        free = [] if contact is None else [foot for foot in (0, 1) if contact[foot] == Contact.UNMEASURED]
        if not free:
            return found
        total = -np.linalg.solve(balance.by_wrench[:ROOT, :6], residual)
        vertical = np.maximum(loads[[6 * foot + 2 for foot in free]], 1.0)
        for foot, share in zip(free, vertical / vertical.sum(), strict=True):
            found[6 * foot : 6 * foot + 6] = share * total
        return found


def _varied(model: Body, directions: Array) -> Sequence[HumanModel]:
    """The body with factors and joint centres a little further along each direction (n, K + E)."""
    inertia, centres_m = (model.inertia, model.centres_m) if isinstance(model, HumanModel) else (None, 0.0)
    count = len(model.scale)
    return [
        HumanModel(
            model.description, model.scale + one[:count], model.mass_kg, inertia, centres_m + one[count:]
        )
        for one in SIZE_STEP * directions
    ]
