"""Functions of the kernel on feet and plates (``contact.c``, ``wrenches.c``): what they take and give."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array


class ContactFunctions(Protocol):
    """Contact of the feet, and their wrenches. Arrays are in C order unless they are symmetric."""

    def feet(self, tree: object, whole: NDArray[np.int32], numbers: Array, plates: Array, /) -> object:
        """A handle of feet and plates: see :class:`mbkf.kernel.contact.CompiledFeet`.

        Args:
            tree: The body's handle.
            whole: (12,) joints and numbers of frames, 32-bit integers.
            numbers: (35,) places, times and limits.
            plates: (K, 23) the plates.

        Raises:
            ValueError: They do not fit the tree.
        """

    def stand(
        self,
        feet: object,
        q: Array,
        v: Array,
        a: Array,
        plates: Array,
        supported: bool,
        before: Array,
        after: Array,
        wrench: Array,
        middles: Array,
        below: Array,
        rest: Array,
        /,
    ) -> int:
        """Fills what the feet stand on: see :class:`mbkf.kernel.contact.Stand`.

        Args:
            feet: The handle.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            plates: (K, 6) wrenches, NaN where not recorded.
            supported: Whether another part than the feet bears.
            before: Memory from the frame before.
            after: Memory filled.
            wrench: (2, 6) filled.
            middles: (2, 3) filled.
            below: (6,) filled.
            rest: (25,) filled.

        Returns:
            The decision's flags.

        Raises:
            ValueError: The memory is that of other feet.
        """

    def wrench_rows(
        self,
        middles: Array,
        right: Array,
        left: Array,
        expected: Array,
        w: Array,
        left_first: bool,
        rows: Array,
        values: Array,
        /,
    ) -> None:
        """Fills rows that read the feet's wrenches: see :meth:`mbkf.sensors.foot_contact.FootContact.linearise`.

        Args:
            middles: (2, 3) of the soles.
            right: (6,) 1/sd of the right foot's rows.
            left: (6,) of the left foot's.
            expected: (2, 6) wrenches as read.
            w: (12,) wrenches.
            left_first: Whether the rows of the left foot come first.
            rows: (12, 12) filled.
            values: (12,) innovations, filled.
        """

    def wrench_walk(self, P: Array, first: int, middles: Array, sd: Array, belt: Array, /) -> None:
        """Adds the wrenches' random walk to P: see :meth:`mbkf.sensors.foot_contact.FootContact.inflate`.

        Args:
            P: (N, N) covariance.
            first: The wrenches' first component.
            middles: (2, 3) of the soles.
            sd: (2,) of force and moment.
            belt: (2,) root of what a belt adds to the horizontal moments.
        """

    def wrenches_possible(self, readings: Array, reach: Array, limits: Array, /) -> bool:
        """Whether a person can make plates read this: see :func:`mbkf.sensors.contact.possible.all_possible`.

        Args:
            readings: (..., K, 6) readings.
            reach: (K,) of the plates.
            limits: (5,) the weight, and the most vertical force, pull, friction and slack.
        """

    def wrench_means(
        self, ring: Array, first: int, weights: Array, width: float, origins: Array, means: Array, /
    ) -> None:
        """Fills plates' means over a window: see :meth:`mbkf.stream.receiving.plate_buffer.PlateBuffer.mean`.

        Args:
            ring: (size, 6 K) the latest readings.
            first: The window's first sample.
            weights: (n,) or (n, 1) of the samples from there on.
            width: The window's width, in samples.
            origins: (K, 3) of the plates.
            means: (K, 6) filled: about the world's origin.

        Raises:
            ValueError: The ring's size does not fit, or the window lies before its beginning.
        """
