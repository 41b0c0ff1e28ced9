"""A body's momentum and weight, linear in the inertial parameters of its segments.

A segment's parameters are φ = [m, m c (3), I_xx, I_xy, I_yy, I_xz, I_yz, I_zz], c its centre of mass and I its moments
about the segment's origin, in its own frame (C. G. Atkeson, C. H. An, J. M. Hollerbach, Int. J. Robotics Res. 5(3)
(1986) 101-119). With the velocity u of that origin o and the angular velocity ω, momentum about the world's origin is

    p = m u + ω × R m c,    L = o × p + R m c × u + R I Rᵀ ω.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.numerics.rotations import skew

PER_SEGMENT = 10
"""Inertial parameters of a segment."""

PER_OWN = 4
"""Numbers of a segment's difference from the table: relative mass, and shift of the centre of mass (3), m."""

_ROWS, _COLUMNS = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
"""Places of the six moments in the matrix, in Pinocchio's order."""

_MOMENTS = np.zeros((3, 3, 6))
_MOMENTS[_ROWS, _COLUMNS, range(6)] = _MOMENTS[_COLUMNS, _ROWS, range(6)] = 1.0


class InertialRegressor:
    """Momentum and weight of a body by its segments' parameters, S of them in the description's order.

    Args:
        model: The body.
    """

    def __init__(self, model: Body) -> None:
        self.model = model
        self.names = tuple(segment.name for segment in model.description.segments)
        self._joints = np.array([model.joint(name).joint_id for name in self.names])
        self._moves = model.supports[self._joints].astype(float)
        self._gravity = np.array(model.pin_model.gravity.linear)

    def table(self) -> Array:
        """(10 S,) the parameters that the body has."""
        inertias = self.model.pin_model.inertias
        return np.concatenate([inertias[int(j)].toDynamicParameters() for j in self._joints])

    def momentum(self, q: Array, v: Array) -> Array:
        """(6, 10 S) momentum N s and angular momentum N m s about the world's origin, world axes, by the parameters."""
        frames, jacobian = self.model.frames_and_jacobian(q)
        rotations, origins = self._placements(frames)
        moving = (jacobian * v) @ self._moves.T
        turning = moving[3:].T
        speed = moving[:3].T + np.cross(turning, origins)
        found = np.zeros((6, len(self.names), PER_SEGMENT))
        found[:3, :, 0] = speed.T
        found[:3, :, 1:4] = (skew(turning) @ rotations).transpose(1, 0, 2)
        found[3:, :, 1:4] = -(skew(speed) @ rotations).transpose(1, 0, 2)
        own = np.einsum("sji,sj->si", rotations, turning)
        found[3:, :, 4:] = np.einsum("sab,bck,sc->ask", rotations, _MOMENTS, own)
        found[3:] += np.einsum("sab,bsk->ask", skew(origins), found[:3])
        return found.reshape(6, -1)

    def weight(self, q: Array) -> Array:
        """(6, 10 S) force N and moment N m of weight about the world's origin, world axes, by the parameters."""
        rotations, origins = self._placements(self.model.frames(q))
        found = np.zeros((6, len(self.names), PER_SEGMENT))
        found[:3, :, 0] = self._gravity[:, None]
        pull = -skew(self._gravity)
        found[3:, :, 0] = pull @ origins.T
        found[3:, :, 1:4] = np.einsum("ab,sbk->ask", pull, rotations)
        return found.reshape(6, -1)

    def own(self, difference: Array) -> tuple[Array, Array]:
        """Parameters of a body that differs from the table, and their derivatives.

        Args:
            difference: (4 S,) by segment, relative change of mass and shift of the centre of mass, m. Moments about
                the centre of mass go with the mass.

        Returns:
            (10 S,) parameters and (10 S, 4 S) derivatives.
        """
        size = len(self.names)
        found, slope = np.zeros((size, PER_SEGMENT)), np.zeros((size, PER_SEGMENT, size, PER_OWN))
        for s, (change, *shift) in enumerate(difference.reshape(size, PER_OWN)):
            inertia = self.model.pin_model.inertias[int(self._joints[s])]
            centre, mass = inertia.lever + shift, float(inertia.mass)
            per_mass = pin.Inertia(mass, centre, inertia.inertia).toDynamicParameters()
            found[s], slope[s, :, s, 0] = (1.0 + change) * per_mass, per_mass
            for axis, unit in enumerate(np.eye(3)):
                turned = 2.0 * centre[axis] * np.eye(3) - np.outer(unit, centre) - np.outer(centre, unit)
                slope[s, 1:4, s, 1 + axis] = (1.0 + change) * mass * unit
                slope[s, 4:, s, 1 + axis] = (1.0 + change) * mass * turned[_ROWS, _COLUMNS]
        return found.ravel(), slope.reshape(size * PER_SEGMENT, size * PER_OWN)

    def _placements(self, frames: Array) -> tuple[Array, Array]:
        by_joint = frames.reshape(-1, 4, 3)[self._joints]
        return by_joint[:, :3].transpose(0, 2, 1), by_joint[:, 3]
