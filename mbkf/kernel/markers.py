"""Markers on a body by the compiled kernel (``markers.c``): places, innovations, and what they say of the posture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.loading import Library, library
from mbkf.kernel.tree import CompiledTree


class Apart(NamedTuple):
    """Markers of a frame beside their predicted places.

    Attributes:
        innovation_m: (M, 3) measured minus predicted, NaN where missing.
        squared_m2: (M,) squared lengths, 0 of missing ones.
        seen: (M,) whether a marker is there.
        near: Whether none of them lies further off than the radius asked for.
    """

    innovation_m: Array
    squared_m2: Array
    seen: BoolArray
    near: bool


class CompiledMarkers:
    """Markers fixed to the segments of a compiled body; arrays that it returns are new ones."""

    def __init__(self, kernel: Library, tree: CompiledTree, joint_ids: Array, local_m: Array) -> None:
        """Keeps where the markers are worn.

        Args:
            kernel: The compiled kernel.
            tree: The body.
            joint_ids: (M,) joints that carry them.
            local_m: (M, 3) places in the joints' frames.
        """
        self._kernel, self._tree, self._nv = kernel, tree.handle, tree.nv
        self._joints = np.ascontiguousarray(joint_ids, dtype=np.int32)
        self._local = np.ascontiguousarray(local_m, dtype=float)

    @classmethod
    def where_built(
        cls, tree: CompiledTree | None, joint_ids: Array, local_m: Array
    ) -> CompiledMarkers | None:
        """They, or None where the body is not compiled.

        Args:
            tree: The body, None for none.
            joint_ids: (M,) joints that carry them.
            local_m: (M, 3) places in the joints' frames.
        """
        kernel = library()
        return None if tree is None or kernel is None else cls(kernel, tree, joint_ids, local_m)

    def places(self, q: Array) -> tuple[Array, Array]:
        """(M, 3) places in the world at q (nq,), and (6, nv) the body's spatial Jacobian there."""
        places, jacobian = np.empty(self._local.shape), np.empty((6, self._nv), order="F")
        self._kernel.marker_places(
            self._tree, self._joints, self._local, np.ascontiguousarray(q), places, jacobian
        )
        return places, jacobian

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
            places_m: (M, 3) they.
            innovation_m: (M, 3) y; those of other markers are not read.
        """
        matrix, vector = np.empty((self._nv, self._nv)), np.empty(self._nv)
        squared = self._kernel.marker_information(
            self._tree, self._joints, weights, trusted, jacobian, places_m, innovation_m, matrix, vector
        )
        return matrix, vector, squared


def apart(measured_m: Array, predicted_m: Array, radius_m: float) -> Apart | None:
    """Innovations of markers, None where there is no compiled kernel.

    Args:
        measured_m: (M, 3) measured places, NaN where missing.
        predicted_m: (M, 3) predicted ones.
        radius_m: How far a near marker lies off at most.
    """
    kernel = library()
    if kernel is None:
        return None
    innovation, squared = np.empty(predicted_m.shape), np.empty(len(predicted_m))
    seen = np.empty(len(predicted_m), dtype=bool)
    measured = np.ascontiguousarray(measured_m, dtype=float)
    found = kernel.markers_apart(measured, predicted_m, radius_m, innovation, squared, seen)
    return Apart(innovation, squared, seen, found >= 0)
