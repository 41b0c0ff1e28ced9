"""Point masses on the segments of a body, whose mass matrix is the information of many points on the configuration.

Readings of points with standard deviations σ inform about the configuration by Λ = Σ σ⁻² HᵀH, H (3, nv) being a point's
Jacobian. That is the mass matrix of masses σ⁻² at the points, which the composite rigid body algorithm finds without
any H (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 6).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body


class PointMasses:
    """Massless segments that carry M points with masses.

    Args:
        model: The body.
        joint_ids: (M,) Pinocchio joints that carry the points.
        local_m: (M, 3) places in the joints' frames.
        masses: (M,) of any unit.
    """

    def __init__(self, model: Body, joint_ids: Array, local_m: Array, masses: Array) -> None:
        self.joint_ids = joint_ids
        self._model = pin.Model(model.pin_model)
        for joint in range(self._model.njoints):
            self._model.inertias[joint] = pin.Inertia.Zero()
        self._data = self._model.createData()
        points = [
            pin.Inertia(mass, place, np.zeros((3, 3))) for mass, place in zip(masses, local_m, strict=True)
        ]
        self._parameters = np.array([point.toDynamicParameters() for point in points]).reshape(-1, 10)
        self._counted = np.zeros(len(joint_ids), dtype=bool)
        self._key = self._counted.tobytes()

    def mass_matrix(self, q: Array, counted: BoolArray) -> Array:
        """(nv, nv) Σ m HᵀH at q over the points with ``counted`` (M,) set, as a new array."""
        if counted.tobytes() != self._key:
            self._count(counted)
        return pin.crba(self._model, self._data, q)

    def _count(self, counted: BoolArray) -> None:
        """Updates the inertias of segments whose set of counted points has changed."""
        for joint in set(self.joint_ids[counted != self._counted]):
            mine = counted & (self.joint_ids == joint)
            inertia = pin.Inertia.Zero()
            if mine.any():
                inertia = pin.Inertia.FromDynamicParameters(self._parameters[mine].sum(axis=0))
            self._model.inertias[int(joint)] = inertia
        self._counted, self._key = counted.copy(), counted.tobytes()
