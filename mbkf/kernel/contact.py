"""Contact of the feet by the compiled kernel (``contact.c``): its constants, and its memory as one array of numbers.

The memory holds, one after the other, with K plates and a window of n frames:

    sole height, touching (2), lowest balls (2), frames airborne, frames held, ranked velocities (2)
    of each plate: its foot, where it was pressed last, x and y, and by which foot
    for x and y: the lowest sole point's velocity in each frame (n); those that are numbers, in ascending order (n)
    of each frame: the pelvis, x, y and z (3 n)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree

HEAD, PER_PLATE, NEVER = 9, 4, -2.0
"""Numbers before those of the plates, numbers of a plate, and the foot that pressed a plate that none has pressed."""

STRAY, ON_ONE_PLATE, ON_OPEN_FLOOR, MOVING_OR_NEAR, BELOW = 16, 32, 64, 128, 256
"""What a decision's flags say besides kinds: a plate belongs to no foot; both feet are on one plate, or both carry
weight where no plate reads; the floor moves or a foot is near to it; plates read less than counts as a load."""

KINDS = 15
"""The bits of a decision's flags that tell its kinds of contact, plus one: two of the right foot, two of the left."""


class CompiledFeet:
    """Feet of a body, and the plates that they may stand on, for the compiled decision."""

    def __init__(self, tree: CompiledTree, whole: NDArray[np.int32], numbers: Array, plates: Array) -> None:
        """Hands constants over.

        Args:
            tree: The body.
            whole: (12,) joints of heel, ball and toe end of right and left sole, of right and left foot, and of the
                root; frames of the floor's velocity, of a floor that stands still, and of a fall. 32-bit integers.
            numbers: (35,) places of the points of the soles in their joints (6, 3), m; height of the lowest plate, m,
                NaN without; time between frames, s; limits (15) in the order of ``feet.h``.
            plates: (K, 23) of each plate: whether its outline is known, least load, N, height, m, box and edges.
        """
        kernel = library()
        assert kernel is not None, "a tree was compiled by a kernel"
        self._stand, self._feet = kernel.stand, kernel.feet(tree.handle, whole, numbers, plates)
        self.plates, self.window = len(plates), int(whole[9])

    @property
    def record_length(self) -> int:
        """How many numbers the memory has."""
        return HEAD + PER_PLATE * self.plates + 7 * self.window

    def stand(
        self, motion: tuple[Array, Array, Array], wrenches: Array, supported: bool, before: Array
    ) -> Stand:
        """What the feet stand on in one frame.

        Args:
            motion: (nq,) configuration, (nv,) velocity and acceleration.
            wrenches: (K, 6) what plates read, N, N m about the world's origin; NaN where not recorded.
            supported: Whether another part than the feet bears.
            before: The memory from the frame before.
        """
        q, v, a = motion
        after, wrench, middles = np.empty(len(before)), np.empty((2, 6)), np.empty((2, 3))
        below, rest = np.empty(6), np.empty(25)
        flags = self._stand(
            self._feet,
            np.ascontiguousarray(q, float),
            np.ascontiguousarray(v, float),
            np.ascontiguousarray(a, float),
            np.ascontiguousarray(wrenches, float),
            supported,
            before,
            after,
            wrench,
            middles,
            below,
            rest,
        )
        after.setflags(write=False)
        return Stand(flags, after, wrench, middles, below, rest)


class Stand(NamedTuple):
    """A compiled decision.

    Attributes:
        flags: What it says.
        after: The memory for the next frame, read-only.
        wrench: (2, 6) measured wrenches of right and left foot.
        middles_m: (2, 3) middles of their soles.
        below: (6,) sum of what plates read that is less than a load.
        rest: (25,) world points of both soles (2, 3, 3), pelvis (3), how near right and left foot are to the floor
            (2), and the floor's horizontal velocity (2).
    """

    flags: int
    after: Array
    wrench: Array
    middles_m: Array
    below: Array
    rest: Array
