"""Contact of the feet by the compiled kernel (``contact.c``): its constants, and its memory as one array of numbers.

The memory holds, one after the other, with K plates and a window of n frames:

    sole height, touching (2), lowest balls (2), frames airborne, frames held, ranked velocities (2)
    of each plate: its foot; x and y of the last centre of pressure, and the foot that pressed there
    for x and y: the lowest sole point's velocity in each frame (n); those that are numbers, in ascending order (n)
    of each frame: the pelvis, x, y and z (3 n)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.contact_functions import ContactLimits
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree

HEAD, PER_PLATE, NEVER = 9, 4, -2.0
"""Numbers before those of the plates, numbers of a plate, and the foot of a plate that was never pressed."""

STRAY, ON_ONE_PLATE, ON_OPEN_FLOOR, MOVING_OR_NEAR, BELOW = 16, 32, 64, 128, 256
"""Flags of a decision beside the kinds: a plate belongs to no foot; both feet are on one plate, or both carry weight
where no plate reads; the floor moves or a foot is near to it; plates read less than counts as a load."""

KINDS = 15
"""Bits of a decision's flags that hold its kinds of contact, plus one: two of the right foot, two of the left."""


class FeetConstants(NamedTuple):
    """Feet on a body.

    Attributes:
        point_joints: Joints of heel, ball and toe end of the right and the left sole.
        points_m: (6, 3) places of these points in their joints.
        foot_joints: Joints of the right and the left foot.
        root_joint: Joint of the root.
        window, still, fall: Numbers of frames: of the floor's velocity, of a floor that stands still, of a fall.
        dt_s: Time between frames.
    """

    point_joints: Sequence[int]
    points_m: Array
    foot_joints: Sequence[int]
    root_joint: int
    window: int
    still: int
    fall: int
    dt_s: float


class CompiledFeet:
    """Feet of a body, and the plates that they may stand on, for the compiled decision."""

    def __init__(self, tree: CompiledTree, feet: FeetConstants, limits: ContactLimits, plates: Array) -> None:
        """Hands constants over.

        Args:
            tree: The body.
            feet: The feet on it.
            limits: Limits of contact.
            plates: (K, 23) of each plate: 1 for a known outline, least load, N, height, m, box (4) and edges (4, 4).
        """
        kernel = library()
        assert kernel is not None, "a tree was compiled by a kernel"
        known, least_n, surface_m = plates[:, :3].T.copy()
        self._decide = kernel.decide_contact
        self._feet = kernel.make_feet(
            tree.handle,
            np.array(feet.point_joints, dtype=np.int32),
            np.array(feet.foot_joints, dtype=np.int32),
            feet.root_joint,
            np.ascontiguousarray(feet.points_m),
            feet.window,
            feet.still,
            feet.fall,
            min(surface_m, default=np.nan),
            feet.dt_s,
            limits,
            known != 0.0,
            least_n,
            surface_m,
            plates[:, 3:7].copy(),
            plates[:, 7:].copy().reshape(-1, 4, 4),
        )

    def stand(
        self, motion: tuple[Array, Array, Array], wrenches: Array, supported: bool, before: Array
    ) -> Stand:
        """Contact of the feet in one frame.

        Args:
            motion: (nq,) configuration, (nv,) velocity and acceleration.
            wrenches: (K, 6) readings of the plates, N, N m about the world's origin; NaN where not recorded.
            supported: True if another part than the feet bears load.
            before: The memory from the frame before.
        """
        q, v, a = (np.ascontiguousarray(one, float) for one in motion)
        wrench = np.ascontiguousarray(wrenches, float)
        stand = Stand(*self._decide(self._feet, q, v, a, wrench, supported, before))
        stand.after.setflags(write=False)
        return stand


class Stand(NamedTuple):
    """A compiled decision.

    Attributes:
        flags: Kinds of contact and flags.
        after: The memory for the next frame, read-only.
        wrench: (2, 6) measured wrenches of right and left foot.
        middles_m: (2, 3) middles of their soles.
        below: (6,) sum of readings that are less than a load.
        soles_m: (2, 3, 3) heel, ball and toe end of both soles in the world.
        pelvis_m: (3,) pelvis in the world.
        near: (2,) nearness of right and left foot to the floor, from 0 to 1.
        floor_m_s: (2,) horizontal velocity of the floor.
    """

    flags: int
    after: Array
    wrench: Array
    middles_m: Array
    below: Array
    soles_m: Array
    pelvis_m: Array
    near: Array
    floor_m_s: Array
