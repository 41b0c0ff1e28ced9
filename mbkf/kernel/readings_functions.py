"""Functions of the kernel on readings (``markers.c``, ``differences.h``): what they take and give."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray


class ReadingFunctions(Protocol):
    """Markers and noise. Arrays are in C order."""

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
