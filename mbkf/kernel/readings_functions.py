"""Functions of the kernel on readings (``markers.c``, ``feet.c``, ``differences.h``): what they take and give."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray

Point = tuple[float, float, float]
Points = tuple[Point, Point, Point]
"""Of heel, ball and toe end."""


class ReadingFunctions(Protocol):
    """Markers, feet and noise. Arrays are in C order."""

    def marker_places(
        self,
        tree: object,
        joints: NDArray[np.int32],
        local: Array,
        q: Array,
        places: Array,
        jacobian: Array,
        /,
    ) -> None:
        """Fills places of markers and the Jacobian.

        Args:
            tree: The handle.
            joints: (M,) joints that carry the markers, 32-bit integers.
            local: (M, 3) places in their frames.
            q: (nq,) configuration.
            places: (M, 3) filled.
            jacobian: (6, nv) filled, in Fortran order.
        """

    def markers_apart(
        self,
        measured: Array,
        places: Array,
        radius: float,
        innovation: Array,
        squared: Array,
        seen: BoolArray,
        /,
    ) -> int:
        """Fills innovations: see :class:`mbkf.kernel.markers.Apart`.

        Args:
            measured: (M, 3) measured places.
            places: (M, 3) predicted ones.
            radius: How far a near marker lies off at most.
            innovation: (M, 3) filled.
            squared: (M,) filled.
            seen: (M,) filled.

        Returns:
            How many are seen; −1 where one of them is not near.
        """

    def marker_information(
        self,
        tree: object,
        joints: NDArray[np.int32],
        weights: Array,
        trusted: BoolArray,
        jacobian: Array,
        places: Array,
        innovation: Array,
        matrix: Array,
        vector: Array,
        /,
    ) -> float:
        """Fills the information of markers and returns yᵀR⁻¹y.

        Args:
            tree: The handle.
            joints: (M,) joints that carry the markers, 32-bit integers.
            weights: (M,) 1/sd².
            trusted: (M,) markers that count.
            jacobian: (6, nv) velocities at the world's origin, in Fortran order.
            places: (M, 3) of the markers.
            innovation: (M, 3) y.
            matrix: (nv, nv) filled.
            vector: (nv,) filled.
        """

    def feet(
        self, tree: object, joints: NDArray[np.int32], local: Array, q: Array, v: Array, middles: Array, /
    ) -> tuple[
        tuple[Points, Points],
        tuple[Points, Points],
        tuple[float, float],
        Point,
        tuple[int, int],
        tuple[int, int],
    ]:
        """Both feet: see :class:`mbkf.kernel.feet.FeetAt`, but for the middles.

        Args:
            tree: The handle.
            joints: (3,) right foot, left foot and root, 32-bit integers.
            local: (6, 3) heel, ball and toe end of right and left sole.
            q: (nq,) configuration.
            v: (nv,) velocity.
            middles: (2, 3) filled with the middles of heels and toe ends.
        """

    def foot_rows(
        self,
        centres: Array,
        weights: Array,
        expected: Array,
        wrench: Array,
        first: int,
        rows: Array,
        values: Array,
        /,
    ) -> None:
        """Fills rows on both feet's wrenches: see :func:`mbkf.kernel.feet.foot_rows`.

        Args:
            centres: (2, 3) points about which they are read.
            weights: (2, 6) 1/sd.
            expected: (2, 6) what is read.
            wrench: (12,) those of the state.
            first: Foot whose rows come first.
            rows: (12, 12) filled.
            values: (12,) filled.
        """

    def foot_walks(self, centres: Array, sd: Array, first: int, P: Array, /) -> None:
        """Adds the wrenches' random walk to a covariance.

        Args:
            centres: (2, 3) points about which they wander.
            sd: (6,) of force and moment.
            first: Component at which the wrenches begin.
            P: (N, N) added to.
        """

    def third_differences(
        self, first: Array, second: Array, third: Array, latest: Array, level: float, /
    ) -> tuple[int, int]:
        """Counts third differences: see :func:`mbkf.kernel.differences.third_differences`.

        Args:
            first: A sample.
            second: The next one, of as many numbers.
            third: The next.
            latest: The latest.
            level: The level.

        Returns:
            How many are numbers, and how many of these lie below the level.
        """
