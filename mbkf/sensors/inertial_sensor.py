"""Expected readings of inertial sensors on a body: angular velocity and specific force, with derivatives.

ω = Rᵀ ω_segment and f = Rᵀ (p̈ − g) at the sensor's place p, from the body's positions, velocities and accelerations.
Departs from Madgwick eqs. 38 and 39, which take finite differences and leave gravity out. Departs from Madgwick eqs.
40–43, whose matrix has the opposite sign and whose rates are twice too large. A turn of the world about the vertical
changes neither reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.imu.mount import ImuMount
from mbkf.model.body import Body
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.rotations import skew

_UP = np.array([0.0, 0.0, GRAVITY_M_S2])


class InertialReading(NamedTuple):
    """Expected readings of S sensors.

    Attributes:
        values: (S, 6) angular velocity rad/s, then specific force m/s², in sensor axes.
        jacobian: (S, 6, 3, nv) derivatives by q, in the tangent space, by v and by a.
    """

    values: Array
    jacobian: Array

    @property
    def by_q(self) -> Array:
        """(S, 6, nv)."""
        return self.jacobian[:, :, 0]

    @property
    def by_v(self) -> Array:
        """(S, 6, nv)."""
        return self.jacobian[:, :, 1]

    @property
    def by_a(self) -> Array:
        """(S, 6, nv)."""
        return self.jacobian[:, :, 2]


class InertialSensor:
    """Inertial sensors on a body.

    Attributes:
        model: The body.
        mounts: Their places.

    Raises:
        UnknownName: The body has no segment of a sensor.
    """

    def __init__(self, model: Body, mounts: Sequence[ImuMount]) -> None:
        self.model, self.mounts = model, tuple(mounts)
        self._data = pin.Data(model.pin_model)
        self._joints = [model.joint(mount.segment).joint_id for mount in mounts]
        rotations = quaternion_matrices(np.array([mount.rotation for mount in mounts]).reshape(-1, 4))
        self._to_sensor = rotations.transpose(0, 2, 1)
        self._cross_place = skew(np.array([mount.position_m for mount in mounts]).reshape(-1, 3))
        self._places = [
            pin.SE3(rotation, np.array(mount.position_m))
            for rotation, mount in zip(rotations, mounts, strict=True)
        ]

    def values(self, q: Array, v: Array, a: Array) -> Array:
        """(S, 6) expected angular velocity rad/s and specific force m/s² in sensor axes.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
        """
        pin.forwardKinematics(self.model.pin_model, self._data, q, v, a)
        return self._read()[0]

    def orientations(self, q: Array) -> Array:
        """(S, 3, 3) rotations sensor → world."""
        rotations, _ = self.model.placements(q)
        return rotations[self._joints] @ self._to_sensor.transpose(0, 2, 1)

    def reading(self, q: Array, v: Array, a: Array) -> InertialReading:
        """Expected readings with their derivatives.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
        """
        model, data = self.model.pin_model, self._data
        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        values, up = self._read()
        count, nv = len(self._joints), self.model.nv
        jacobian = np.zeros((count, 6, 3, nv))
        for k, (joint, place) in enumerate(zip(self._joints, self._places, strict=True)):
            velocity = pin.getJointVelocityDerivatives(model, data, joint, pin.LOCAL)
            force = pin.getPointClassicAccelerationDerivatives(model, data, joint, place, pin.LOCAL)
            rates, forces = jacobian[k, :3], jacobian[k, 3:]
            rates[:, 0], rates[:, 1] = velocity[0][3:], velocity[1][3:]
            forces[:, 0], forces[:, 1], forces[:, 2] = force[1], force[2], force[3]
        rates = self._to_sensor @ jacobian[:, :3, :2].reshape(count, 3, 2 * nv)
        jacobian[:, :3, :2] = rates.reshape(count, 3, 2, nv)
        jacobian[:, 3:, 0] += skew(up) @ rates[..., nv:]  # gravity turns against the sensor
        return InertialReading(values, jacobian)

    def _read(self) -> tuple[Array, Array]:
        """(S, 6) values from the kinematics at hand, and g upwards (S, 3) in sensor axes."""
        data = self._data
        velocity = np.array([data.v[j].vector for j in self._joints]).reshape(-1, 6)
        acceleration = np.array([data.a[j].vector for j in self._joints]).reshape(-1, 6)
        up = np.array([_UP @ data.oMi[j].rotation for j in self._joints]).reshape(-1, 3)
        omega = velocity[:, 3:, None]
        turning = skew(velocity[:, 3:])
        # Spatial to classical acceleration, then to the sensor's place.
        here = turning @ (velocity[:, :3, None] - self._cross_place @ omega)
        here += acceleration[:, :3, None] - self._cross_place @ acceleration[:, 3:, None]
        up = self._to_sensor @ up[:, :, None]
        values = np.concatenate([self._to_sensor @ omega, self._to_sensor @ here + up], axis=1)
        return values[:, :, 0], up[:, :, 0]
