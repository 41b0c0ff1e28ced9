"""Markers on a body by the compiled kernel (``markers.c``): places, innovations, and information on the posture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree


class Innovations(NamedTuple):
    """Measured markers of a frame against their predicted places.

    Attributes:
        near: True if all of them lie within the radius asked for.
        innovation_m: (M, 3) measured minus predicted, NaN where missing.
        squared_m2: (M,) squared lengths, 0 of missing ones.
        seen: (M,) True for markers that are not missing.
    """

    near: bool
    innovation_m: Array
    squared_m2: Array
    seen: BoolArray


class CompiledMarkers:
    """Markers fixed to the segments of a compiled body.

    Attributes:
        joint_ids: (M,) joints that carry them.
        local_m: (M, 3) places in the joints' frames.
    """

    def __init__(self, tree: CompiledTree, joint_ids: Array, local_m: Array) -> None:
        """Keeps the markers' places.

        Args:
            tree: The body.
            joint_ids: (M,) joints that carry them.
            local_m: (M, 3) places in the joints' frames.
        """
        self._kernel, self._tree = tree.kernel, tree.handle
        self.joint_ids = np.ascontiguousarray(joint_ids, dtype=np.int32)
        self.local_m = np.ascontiguousarray(local_m, dtype=float)

    def places(self, q: Array, local_m: Array | None = None) -> tuple[Array, Array]:
        """(M, 3) places in the world at q (nq,), and (6, nv) the body's spatial Jacobian there.

        Args:
            q: (nq,) configuration.
            local_m: (M, 3) places in the joints' frames, contiguous; None for those that are kept.
        """
        local = self.local_m if local_m is None else local_m
        return self._kernel.marker_places(self._tree, self.joint_ids, local, np.ascontiguousarray(q))

    def information(
        self,
        weights: Array,
        trusted: BoolArray,
        jacobian: Array,
        places_m: Array,
        innovation_m: Array,
    ) -> tuple[Array, Array, float]:
        """Σ w HᵀH (nv, nv), Σ w Hᵀy (nv,) and Σ w yᵀy of the trusted markers, H a marker's Jacobian.

        Args:
            weights: (M,) w, 1/m².
            trusted: (M,) markers that count.
            jacobian: (6, nv) that of :meth:`places`.
            places_m: (M, 3) those of :meth:`places`.
            innovation_m: (M, 3) y; those of other markers are not read.
        """
        squared, matrix, vector = self._kernel.marker_information(
            self._tree, self.joint_ids, weights, trusted, jacobian, places_m, innovation_m
        )
        return matrix, vector, squared


def innovations(measured_m: Array, predicted_m: Array, radius_m: float) -> Innovations | None:
    """Innovations of markers, None without a compiled kernel.

    Args:
        measured_m: (M, 3) measured places, NaN where missing.
        predicted_m: (M, 3) predicted ones.
        radius_m: Greatest distance of a near marker.
    """
    kernel = library()
    if kernel is None:
        return None
    measured = np.ascontiguousarray(measured_m, dtype=float)
    return Innovations(*kernel.marker_innovations(measured, predicted_m, radius_m))
