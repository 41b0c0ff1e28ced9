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
from mbkf.numerics.kalman import Information, information


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


@dataclass(frozen=True)
class MarkerPrediction:
    """Markers predicted from a state.

    Attributes:
        reading: The markers at the predicted configuration; its Jacobian H is computed on demand.
        covariance: (nv, nv) covariance P⁻ of the predicted configuration in its tangent space.
    """

    reading: MarkerReading
    covariance: Array

    @property
    def positions_m(self) -> Array:
        """(M, 3) predicted positions ĥ(x⁻) in the world, m."""
        return self.reading.positions_m

    def spread(self, markers: BoolArray) -> Array:
        """(m, 3, 3) covariance H P⁻ Hᵀ of the chosen markers' (M,) predicted positions, m²."""
        H = self.reading.only(markers).jacobian
        return (H @ self.covariance) @ H.transpose(0, 2, 1)


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
        of_segment = {name: model.joint(name).joint_id for name in dict.fromkeys(self.segments)}
        self.joint_ids = np.array([of_segment[name] for name in self.segments], dtype=int)
        self._moves = model.supports[self.joint_ids].astype(float)
        tree = model.tree
        self.compiled = None if tree is None else CompiledMarkers(tree, self.joint_ids, self.local_m)

    @cached_property
    def _places(self) -> Array:
        return self.weights(self.local_m)

    def weights(self, local_m: Array) -> Array:
        """(M, 4 J) weights of the joints' axes and origins in the positions of markers at (M, 3) in their segments."""
        places = np.zeros((len(self.segments), len(self.model.supports), 4))
        places[np.arange(len(self.segments)), self.joint_ids] = np.insert(local_m, 3, 1.0, axis=1)
        return places.reshape(len(self.segments), 4 * len(self.model.supports))

    def local_at(self, q: Array) -> Array:
        """(M, 3) positions in the segments' frames at q (nq,), m: the same at every configuration here."""
        return self.local_m

    def positions(self, q: Array) -> Array:
        """(M, 3) world positions at the configuration q (nq,)."""
        if self.compiled is not None:
            return self.compiled.places(q)[0]
        return self._places @ self.model.frames(q)

    def reading(self, q: Array) -> MarkerReading:
        """Positions and their Jacobian at q (nq,)."""
        if self.compiled is not None:
            return self.reading_of(*self.compiled.places(q))
        frames, jacobian = self.model.frames_and_jacobian(q)
        return self.reading_of(self._places @ frames, jacobian)

    def reading_of(self, positions_m: Array, spatial: Array) -> MarkerReading:
        """A reading of known positions (M, 3) and spatial Jacobian (6, nv) of the body."""
        return MarkerReading(positions_m, spatial, self._moves)


class JacobianInformation:
    """Information of a frame's markers on the configuration, by the markers' Jacobian.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) standard deviation of each marker.
    """

    def __init__(self, sensor: MarkerSensor, noise_m: Array) -> None:
        self.sensor, self.noise_m = sensor, noise_m

    def at(
        self,
        reading: MarkerReading,
        innovation_m: Array,
        trusted: BoolArray,
        noise_scale: float = 1.0,
    ) -> Information:
        """Information on the configuration (nv).

        Args:
            reading: The sensor's at the configuration.
            innovation_m: (M, 3) measured minus predicted, NaN where missing.
            trusted: (M,) markers that count, all of them seen.
            noise_scale: Square of a factor on their noise.
        """
        H = reading.jacobian[trusted].reshape(-1, self.sensor.model.nv)
        sd = np.repeat(self.noise_m[trusted] * noise_scale**0.5, 3)
        return information(innovation_m[trusted].ravel(), H, sd)


class MarkerInformation(JacobianInformation):
    """The same by the compiled kernel where there is one, which needs no Jacobian; equal up to rounding."""

    def __init__(self, sensor: MarkerSensor, noise_m: Array) -> None:
        super().__init__(sensor, noise_m)
        self._weight = noise_m**-2.0

    def at(
        self,
        reading: MarkerReading,
        innovation_m: Array,
        trusted: BoolArray,
        noise_scale: float = 1.0,
    ) -> Information:
        """Information on the configuration (nv), as the base class's."""
        if (compiled := self.sensor.compiled) is None:
            return super().at(reading, innovation_m, trusted, noise_scale)
        weight = self._weight * (1.0 / noise_scale)
        found = compiled.information(weight, trusted, reading.spatial, reading.positions_m, innovation_m)
        return Information(*found, 3 * trusted.tobytes().count(1))
