"""Both feet of a body by the compiled kernel (``feet.c``): soles, velocities, and rows on the wrenches they carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import Library, library
from mbkf.kernel.readings_functions import Point, Points
from mbkf.kernel.tree import CompiledTree


class FeetAt(NamedTuple):
    """Right and left foot at one state.

    Attributes:
        points: World positions of heel, ball and toe end, m.
        velocities: Their velocities, m/s.
        up: Vertical component of each foot's upward axis.
        root: The root's origin, m.
        lowest: The lowest point of each sole, 0 heel, 1 ball, 2 toe end.
        lowest_end: The lower one of heel and ball.
        middles_m: (2, 3) middle of heel and toe end.
    """

    points: tuple[Points, Points]
    velocities: tuple[Points, Points]
    up: tuple[float, float]
    root: Point
    lowest: tuple[int, int]
    lowest_end: tuple[int, int]
    middles_m: Array


class CompiledFeet:
    """The feet of a compiled body."""

    def __init__(
        self, kernel: Library, tree: CompiledTree, joints: tuple[int, int, int], local_m: Array
    ) -> None:
        """Keeps where the soles are.

        Args:
            kernel: The compiled kernel.
            tree: The body.
            joints: Those of right foot, left foot and root.
            local_m: (6, 3) heel, ball and toe end of right and left sole in their feet's frames.
        """
        self._kernel, self._tree = kernel, tree.handle
        self._joints, self._local = (
            np.array(joints, dtype=np.int32),
            np.ascontiguousarray(local_m, dtype=float),
        )

    @classmethod
    def where_built(
        cls, tree: CompiledTree | None, joints: tuple[int, int, int], local_m: Array
    ) -> CompiledFeet | None:
        """They, or None where the body is not compiled.

        Args:
            tree: The body, None for none.
            joints: Those of right foot, left foot and root.
            local_m: (6, 3) heel, ball and toe end of right and left sole in their feet's frames.
        """
        kernel = library()
        return None if tree is None or kernel is None else cls(kernel, tree, joints, local_m)

    def at(self, q: Array, v: Array) -> FeetAt:
        """Both feet at a configuration q (nq,) and velocity v (nv,)."""
        middles = np.empty((2, 3))
        q, v = np.ascontiguousarray(q, dtype=float), np.ascontiguousarray(v, dtype=float)
        return FeetAt(*self._kernel.feet(self._tree, self._joints, self._local, q, v, middles), middles)


def foot_rows(
    centres_m: Array, weights: Array, expected: Array, wrench: Array, first: int
) -> tuple[Array, Array] | None:
    """(12, 12) whitened rows on both feet's wrenches and (12,) innovations; None without a kernel.

    Args:
        centres_m: (2, 3) point about which each wrench is read.
        weights: (2, 6) 1/sd of the readings: force and moment.
        expected: (2, 6) wrenches that are read, about the world's origin.
        wrench: (12,) those of the state.
        first: Foot whose rows come first, 0 right and 1 left.
    """
    kernel = library()
    if kernel is None:
        return None
    rows, values = np.empty((12, 12)), np.empty(12)
    kernel.foot_rows(centres_m, weights, expected, wrench, first, rows, values)
    return rows, values


def walked(centres_m: Array, sd: Array, first: int, P: Array) -> bool:
    """Adds the wrenches' random walk to a covariance in place; False without a kernel.

    Args:
        centres_m: (2, 3) points about which right and left foot's wrench wanders.
        sd: (6,) of force and moment.
        first: Component of the state at which the wrenches begin.
        P: (N, N) symmetric covariance.
    """
    kernel = library()
    if kernel is None:
        return False
    kernel.foot_walks(centres_m, sd, first, P)
    return True
