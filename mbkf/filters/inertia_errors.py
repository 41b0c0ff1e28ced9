"""Errors of generalised forces caused by errors of segment masses and centres of mass.

Generalised forces are linear in the inertial parameters of the segments, τ = Y(q, v, a) φ (Atkeson 1986). A person
differs from the table by δφ with covariance L Lᵀ, so that forces err by Y L.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.inertia_spread import CENTRE_SD, MASS_SD, WHOLE_SD, inertia_precision
from mbkf.model.inertial_regressor import PER_SEGMENT, InertialRegressor
from mbkf.numerics.principal import of_unit_length, principal_directions

KEPT_VARIANCE = 0.99
"""Share of the variance of forces that is kept, over random motions."""

MOTIONS, POSTURE_RAD, ACCELERATION = 10, 0.4, 20.0
"""Forces are compared in so many motions, with joints turned and accelerated so far (1 sd): rad, rad/s²."""


class InertiaErrors:
    """Errors by inertial parameters, for one body.

    Attributes:
        root: (10 J, r) L, of the parameters of every joint's segment.
    """

    def __init__(self, model: Body) -> None:
        self._model, self._data = model.pin_model, model.pin_model.createData()
        regressor = InertialRegressor(model)
        _, slope = regressor.own(np.zeros(4 * len(regressor.names)))
        precision = inertia_precision(regressor, MASS_SD, CENTRE_SD, WHOLE_SD)
        own = slope @ np.linalg.inv(np.linalg.cholesky(precision)).T
        whole = np.zeros((self._model.njoints - 1, PER_SEGMENT, own.shape[1]))
        whole[[model.joint(name).joint_id - 1 for name in regressor.names]] = own.reshape(
            -1, *whole.shape[1:]
        )
        self.root = whole.reshape(-1, own.shape[1])
        self.root = self.root @ self._directions(model)

    def _directions(self, model: Body) -> Array:
        """(r, n) orthonormal directions of L's columns in which nearly all of every force's variance lies."""
        rng, nv = np.random.default_rng(0), model.nv
        rows = []
        for _ in range(MOTIONS):
            q = model.integrate(model.neutral(), POSTURE_RAD * rng.normal(size=nv))
            rows.append(self.at(q, np.zeros(nv), ACCELERATION * rng.normal(size=nv)))
        return principal_directions(of_unit_length(np.concatenate(rows)), KEPT_VARIANCE)

    def at(self, q: Array, v: Array, a: Array) -> Array:
        """(nv, r) Y L of a motion.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
        """
        return self.regressor(q, v, a) @ self.root

    def regressor(self, q: Array, v: Array, a: Array) -> Array:
        """(nv, 10 J) Y of a motion. Args: as for :meth:`at`."""
        return np.asarray(pin.computeJointTorqueRegressor(self._model, self._data, q, v, a))
