"""What the cameras should see: marker positions and their derivatives (eqs. 3.4, 3.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import ShapeError
from mbkf.model.human import HumanModel


@dataclass(frozen=True)
class MarkerReading:
    """Predicted markers: ``positions_m`` (M, 3) in the world and ``jacobian`` (M, 3, nv) in the tangent space."""

    positions_m: Array
    jacobian: Array


class MarkerSensor:
    """Markers fixed to segments of a body: m = r_b + A_b m̄ (eq. 3.4).

    Attributes:
        model: The body.
        segments: Segment of each of the M markers.
        local_m: (M, 3) positions in the segments' frames, m.
        joint_ids: (M,) Pinocchio joints that carry them.
    """

    def __init__(self, model: HumanModel, segments: Sequence[str], local_m: Array) -> None:
        self.model = model
        self.segments = tuple(segments)
        self.local_m = read_only(local_m)
        if self.local_m.shape != (len(self.segments), 3):
            raise ShapeError("local_m", f"({len(self.segments)}, 3)", self.local_m.shape)
        self.joint_ids = np.array([model.joint(name).joint_id for name in self.segments], dtype=int)
        self._moves = model.supports[self.joint_ids][:, None, :]

    def positions(self, q: Array) -> Array:
        """(M, 3) world positions at the configuration q (nq,)."""
        rotations, origins = self.model.placements(q)
        return self._place(rotations, origins)

    def reading(self, q: Array) -> MarkerReading:
        """Positions and their Jacobian at q (nq,): δm = (v + ω × m) δq for the dofs below the marker."""
        rotations, origins, jacobian = self.model.placements_and_jacobian(q)
        positions = self._place(rotations, origins)
        linear, angular = jacobian[:3], jacobian[3:]
        x, y, z = positions.T[:, :, None]
        moved = np.empty((len(positions), 3, jacobian.shape[1]))
        moved[:, 0] = linear[0] + angular[1] * z - angular[2] * y
        moved[:, 1] = linear[1] + angular[2] * x - angular[0] * z
        moved[:, 2] = linear[2] + angular[0] * y - angular[1] * x
        return MarkerReading(positions, np.where(self._moves, moved, 0.0))

    def _place(self, rotations: Array, origins: Array) -> Array:
        ids = self.joint_ids
        return origins[ids] + np.einsum("mij,mj->mi", rotations[ids], self.local_m)
