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
from mbkf.sensors.shoulder_girdle import ShoulderGirdle


class ScaledReading(NamedTuple):
    """M markers on a scaled body at N configurations.

    Attributes:
        markers: Places and Jacobian at each configuration.
        by_factors: (N, M, 3, K) derivatives of the places by the scale factors.
        axes: (N, M, 3, 3) the same by the marker's own offset: the axes of its segment.
        trunks: (N, G, 3, 3) axes of the segments on which shoulders rise.
    """

    markers: list[MarkerReading]
    by_factors: Array
    axes: Array
    trunks: Array


class ScaledMarkers:
    """M markers fixed to segments of a body of any scale factors.

    Attributes:
        sensor: The markers at their reference places on the model.
        girdle: The markers that move with the shoulders.
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
        self.girdle = ShoulderGirdle(model, segments, reference_m)
        self._joint_of_dof = np.empty(model.nv, dtype=np.intp)
        for joint in model.joints.values():
            self._joint_of_dof[joint.v] = joint.joint_id

    def places(
        self, poses: Array, factors: Array, offsets_m: Array | float = 0.0, raised_m: Array | None = None
    ) -> Array:
        """(N, M, 3) world positions.

        Args:
            poses: (N, nq) configurations.
            factors: (K,) scale factors.
            offsets_m: (M, 3) distances from the scaled reference places, in the segments' frames; (N, M, 3) where they
                differ between configurations.
            raised_m: (N, G, 3) displacements of the shoulders along their trunk's axes; None without any.
        """
        frames = np.array([self._model.frames(q) for q in poses]).reshape(len(poses), -1, 4, 3)
        axes = frames[:, self._joints, :3].swapaxes(2, 3)
        raised = self._raised(frames, raised_m)
        return self._placed(axes, frames, self._moved(frames, factors, raised), factors, offsets_m, raised)

    def reading(
        self, poses: Array, factors: Array, offsets_m: Array | float = 0.0, raised_m: Array | None = None
    ) -> ScaledReading:
        """Positions with all derivatives. Args: as :meth:`places`."""
        found = [self._model.frames_and_jacobian(q) for q in poses]
        frames = np.array([one for one, _ in found]).reshape(len(poses), -1, 4, 3)
        spatial = np.array([one.T for _, one in found])
        axes = frames[:, self._joints, :3].swapaxes(2, 3)
        raised = self._raised(frames, raised_m)
        moved = self._moved(frames, factors, raised)
        spatial[:, :, :3] += np.cross(moved[:, self._joint_of_dof], spatial[:, :, 3:])
        placed = self._placed(axes, frames, moved, factors, offsets_m, raised)
        origins = self._levers.summed(frames[:, :, :3].swapaxes(2, 3), self._levers.levers, self._joints)
        markers = [self.sensor.reading_of(*one) for one in zip(placed, spatial.swapaxes(1, 2), strict=True)]
        trunks = frames[:, self.girdle.trunk_ids, :3].swapaxes(2, 3)
        return ScaledReading(markers, origins + axes @ self._by_scale, axes, trunks)

    def by_centres(self, poses: Array) -> Array:
        """(N, M, 3, E) derivatives of the places by displacements of joint centres, at configurations (N, nq)."""
        frames = np.array([self._model.frames(q) for q in poses]).reshape(len(poses), -1, 4, 3)
        rotations = frames[:, :, :3].swapaxes(2, 3)
        return self._levers.summed(rotations, self._levers.centre_levers, self._joints)

    def _raised(self, frames: Array, raised_m: Array | None) -> Array | None:
        """(N, G, 3) displacements of the shoulders in the world."""
        if raised_m is None:
            return None
        return np.einsum("ngji,ngj->ngi", frames[:, self.girdle.trunk_ids, :3], raised_m)

    def _moved(self, frames: Array, factors: Array, raised: Array | None) -> Array:
        """(N, J, 3) displacement of the joints by the scale factors and the shoulders, from the model's."""
        levers = self._levers.levers @ (factors - self._model.scale)
        moved = self._levers.summed(frames[:, :, :3].swapaxes(2, 3), levers[:, :, None])[..., 0]
        return moved if raised is None else moved + self.girdle.below @ raised

    def _placed(
        self,
        axes: Array,
        frames: Array,
        moved: Array,
        factors: Array,
        offsets_m: Array | float,
        raised: Array | None,
    ) -> Array:
        local = self._by_scale @ factors + offsets_m
        origins = (frames[:, :, 3] + moved)[:, self._joints]
        if raised is not None:
            origins = origins + self.girdle.on_trunk @ raised
        return np.ascontiguousarray(origins + (axes @ local[..., None])[..., 0])
