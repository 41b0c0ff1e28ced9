"""Expected marker positions and their derivatives (thesis eqs. 3.4, 3.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import ShapeError
from mbkf.kernel.markers import CompiledMarkers
from mbkf.model.body import Body
from mbkf.model.point_masses import PointMasses
from mbkf.numerics.kalman import Information, information

_NEXT, _AFTER = np.array([1, 2, 0]), np.array([2, 0, 1])
"""Components y, z, x and z, x, y of a vector."""


@dataclass(frozen=True)
class MarkerReading:
    """Predicted markers at one configuration; its arrays are its own.

    Attributes:
        positions_m: (M, 3) in the world.
        spatial: (6, nv) velocity (linear, angular) at the world origin of the segments that each dof moves.
        _moves: (M, nv) True for a dof that moves a marker.
    """

    positions_m: Array
    spatial: Array
    _moves: BoolArray

    @property
    def moves(self) -> Array:
        """(M, nv) 1 for a dof that moves a marker: markers of one segment have the same row."""
        return np.asarray(self._moves, dtype=float)

    def only(self, markers: BoolArray) -> MarkerReading:
        """The reading of some of the markers (M,)."""
        return MarkerReading(self.positions_m[markers], self.spatial, self._moves[markers])

    @cached_property
    def jacobian(self) -> Array:
        """(M, 3, nv) in the tangent space: δm = (v + ω × m) δq for the dofs below the marker; built on demand."""
        x, y, z = self.positions_m.T
        velocity = np.zeros((len(x), 3, 6))
        velocity[:, (0, 1, 2), (0, 1, 2)] = 1.0
        velocity[:, 0, 4], velocity[:, 0, 5] = z, -y
        velocity[:, 1, 3], velocity[:, 1, 5] = -z, x
        velocity[:, 2, 3], velocity[:, 2, 4] = y, -x
        moved = (velocity.reshape(-1, 6) @ self.spatial).reshape(len(x), 3, self.spatial.shape[1])
        moved *= self._moves[:, None, :]
        return moved

    def pull(self, forces: Array) -> Array:
        """(nv,) Σ Hᵀ f of forces (M, 3) at the markers, without the Jacobian H."""
        p, f, wrench = self.positions_m.T, forces.T, np.empty((6, len(forces)))
        wrench[:3], moment = f, wrench[3:]
        # p × f, all components at once.
        np.multiply(p.take(_NEXT, 0), f.take(_AFTER, 0), out=moment)
        moment -= p.take(_AFTER, 0) * f.take(_NEXT, 0)
        return np.einsum("ik,ik->k", self.spatial, wrench @ self._moves)


class MarkerSensor:
    """Markers fixed to segments of a body: m = r_b + A_b m̄ (thesis eq. 3.4).

    Attributes:
        model: The body.
        segments: Segment of each of the M markers.
        local_m: (M, 3) positions in the segments' frames, m.
        joint_ids: (M,) Pinocchio joints that carry them.
        compiled: The markers in compiled code, None without a kernel.
    """

    def __init__(self, model: Body, segments: Sequence[str], local_m: Array) -> None:
        self.model = model
        self.segments = tuple(segments)
        self.local_m = read_only(local_m)
        if self.local_m.shape != (len(self.segments), 3):
            raise ShapeError("local_m", f"({len(self.segments)}, 3)", self.local_m.shape)
        self.joint_ids = np.array([model.joint(name).joint_id for name in self.segments], dtype=int)
        self._moves = model.supports[self.joint_ids].astype(float)
        places = np.zeros((len(self.segments), len(model.supports), 4))
        places[np.arange(len(self.segments)), self.joint_ids] = np.insert(self.local_m, 3, 1.0, axis=1)
        self._places = places.reshape(len(self.segments), 4 * len(model.supports))
        self.compiled = CompiledMarkers.where_built(model.tree, self.joint_ids, self.local_m)

    def positions(self, q: Array) -> Array:
        """(M, 3) world positions at the configuration q (nq,)."""
        if self.compiled is not None:
            return self.compiled.places(q)[0]
        return self._places @ self.model.frames(q)

    def reading(self, q: Array) -> MarkerReading:
        """Positions and their Jacobian at q (nq,)."""
        if self.compiled is not None:
            positions, jacobian = self.compiled.places(q)
            return MarkerReading(positions, jacobian, self._moves)
        frames, jacobian = self.model.frames_and_jacobian(q)
        return MarkerReading(self._places @ frames, jacobian, self._moves)


class MarkerInformation:
    """Information of markers on the configuration, without their Jacobian.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) standard deviation of each.
    """

    def __init__(self, sensor: MarkerSensor, noise_m: Array) -> None:
        self.sensor, self.noise_m = sensor, noise_m
        self._weight = noise_m**-2.0
        self._masses = PointMasses(sensor.model, sensor.joint_ids, sensor.local_m, self._weight)

    def at(
        self,
        q: Array,
        reading: MarkerReading,
        innovation_m: Array,
        trusted: BoolArray,
        noise_scale: float = 1.0,
    ) -> Information:
        """Information on the configuration (nv).

        Args:
            q: (nq,) configuration.
            reading: The sensor's at q.
            innovation_m: (M, 3) measured minus predicted, NaN where missing.
            trusted: (M,) markers that count, all of them seen.
            noise_scale: Square of a factor on their noise.
        """
        count = trusted.tobytes().count(1)
        if (compiled := self.sensor.compiled) is not None:
            weight = self._weight * (1.0 / noise_scale)
            said = compiled.information(weight, trusted, reading.spatial, reading.positions_m, innovation_m)
            return Information(*said, 3 * count)
        y = innovation_m if count == len(trusted) else np.where(trusted[:, None], innovation_m, 0.0)
        forces = y * self._weight[:, None]
        matrix = self._masses.mass_matrix(q, trusted)
        found = Information(matrix, reading.pull(forces), float(np.vdot(forces, y)), 3 * count)
        return found if noise_scale == 1.0 else found.scaled(1.0 / noise_scale)


class JacobianInformation:
    """The same by the markers' Jacobian: slower, and equal to :class:`MarkerInformation` up to rounding."""

    def __init__(self, sensor: MarkerSensor, noise_m: Array) -> None:
        self.noise_m, self._nv = noise_m, sensor.model.nv

    def at(
        self,
        q: Array,
        reading: MarkerReading,
        innovation_m: Array,
        trusted: BoolArray,
        noise_scale: float = 1.0,
    ) -> Information:
        """Args: as :meth:`MarkerInformation.at`; q is not used."""
        del q
        H = reading.jacobian[trusted].reshape(-1, self._nv)
        return information(
            innovation_m[trusted].ravel(), H, np.repeat(self.noise_m[trusted] * noise_scale**0.5, 3)
        )
