"""Markers on a body of any scale factors, from the reference body alone.

The axes of the joints do not depend on the scale factors k, and places are linear in them: m = r_b(k) + A_b (D_b(k) m̄ +
δ) with the reference place m̄ and an offset δ. So no other body is built, which takes longer than all of its places.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel
from mbkf.model.scale_derivatives import OriginLevers
from mbkf.sensors.marker_sensor import MarkerReading, MarkerSensor


class ScaledReading(NamedTuple):
    """M markers on a scaled body at N configurations.

    Attributes:
        markers: Places and Jacobian at each configuration.
        by_factors: (N, M, 3, K) derivatives of the places by the scale factors.
        axes: (N, M, 3, 3) the same by the marker's own offset: the axes of its segment.
    """

    markers: list[MarkerReading]
    by_factors: Array
    axes: Array


class ScaledMarkers:
    """M markers fixed to segments of a body of any scale factors.

    Attributes:
        sensor: The markers at their reference places on the model.
    """

    def __init__(self, model: HumanModel, segments: Sequence[str], reference_m: Array) -> None:
        """Prepares the derivatives.

        Args:
            model: A body of the same description, of any scale factors.
            segments: Segment of each marker.
            reference_m: (M, 3) places on the reference body, in the segments' frames.
        """
        self.sensor = MarkerSensor(model, segments, reference_m)
        self._model, self._joints = model, self.sensor.joint_ids
        scale = {segment.name: segment.scale_matrix for segment in model.description.segments}
        self._by_scale = np.array([scale[name] for name in segments]) * reference_m[:, :, None]
        self._levers = OriginLevers(model)
        self._joint_of_dof = np.empty(model.nv, dtype=np.intp)
        for joint in model.joints.values():
            self._joint_of_dof[joint.v] = joint.joint_id

    def places(self, poses: Array, factors: Array, offsets_m: Array | float = 0.0) -> Array:
        """(N, M, 3) world positions.

        Args:
            poses: (N, nq) configurations.
            factors: (K,) scale factors.
            offsets_m: (M, 3) distances from the scaled reference places, in the segments' frames; (N, M, 3) where they
                differ between configurations.
        """
        frames = np.array([self._model.frames(q) for q in poses]).reshape(len(poses), -1, 4, 3)
        axes = frames[:, self._joints, :3].swapaxes(2, 3)
        return self._placed(axes, frames, self._moved(frames, factors), factors, offsets_m)

    def reading(self, poses: Array, factors: Array, offsets_m: Array | float = 0.0) -> ScaledReading:
        """Positions with all derivatives. Args: as :meth:`places`."""
        found = [self._model.frames_and_jacobian(q) for q in poses]
        frames = np.array([one for one, _ in found]).reshape(len(poses), -1, 4, 3)
        spatial = np.array([one.T for _, one in found])
        axes = frames[:, self._joints, :3].swapaxes(2, 3)
        moved = self._moved(frames, factors)
        spatial[:, :, :3] += np.cross(moved[:, self._joint_of_dof], spatial[:, :, 3:])
        placed = self._placed(axes, frames, moved, factors, offsets_m)
        origins = self._levers.summed(frames[:, :, :3].swapaxes(2, 3), self._levers.levers, self._joints)
        markers = [self.sensor.reading_of(*one) for one in zip(placed, spatial.swapaxes(1, 2), strict=True)]
        return ScaledReading(markers, origins + axes @ self._by_scale, axes)

    def by_centres(self, poses: Array) -> Array:
        """(N, M, 3, E) derivatives of the places by displacements of joint centres, at configurations (N, nq)."""
        frames = np.array([self._model.frames(q) for q in poses]).reshape(len(poses), -1, 4, 3)
        rotations = frames[:, :, :3].swapaxes(2, 3)
        return self._levers.summed(rotations, self._levers.centre_levers, self._joints)

    def _moved(self, frames: Array, factors: Array) -> Array:
        """(N, J, 3) displacement of the joints by the scale factors, from the model's."""
        levers = self._levers.levers @ (factors - self._model.scale)
        return self._levers.summed(frames[:, :, :3].swapaxes(2, 3), levers[:, :, None])[..., 0]

    def _placed(
        self, axes: Array, frames: Array, moved: Array, factors: Array, offsets_m: Array | float
    ) -> Array:
        local = self._by_scale @ factors + offsets_m
        origins = frames[:, :, 3] + moved
        return np.ascontiguousarray(origins[:, self._joints] + (axes @ local[..., None])[..., 0])
