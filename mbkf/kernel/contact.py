"""Contact of the feet by the compiled kernel (``contact.c``): its decision, and its memory as one array of numbers.

The memory holds, one after the other, with K plates and a window of n frames:

    sole height, touching (2), lowest balls (2), frames airborne, frames held, ranked velocities (2)
    of each plate: its foot; x and y of the last centre of pressure, and the foot that pressed there
    for x and y: the lowest sole point's velocity in each frame (n); those that are numbers, in ascending order (n)
    of each frame: the pelvis, x, y and z (3 n)
"""

from __future__ import annotations

from typing import NamedTuple

from mbkf.conventions import Array

HEAD, PER_PLATE, NEVER = 9, 4, -2.0
"""Numbers before those of the plates, numbers of a plate, and the foot of a plate that was never pressed."""

STRAY, ON_ONE_PLATE, ON_OPEN_FLOOR, MOVING_OR_NEAR, BELOW = 16, 32, 64, 128, 256
"""Flags of a decision beside the kinds: a plate belongs to no foot; both feet are on one plate, or both carry weight
where no plate reads; the floor moves or a foot is near to it; plates read less than counts as a load."""

KINDS = 15
"""Bits of a decision's flags that hold its kinds of contact, plus one: two of the right foot, two of the left."""


class Stand(NamedTuple):
    """A decision, as :meth:`mbkf.kernel.contact_functions.ContactFunctions.decide_contact` returns it.

    Attributes:
        flags: Kinds of contact and flags.
        after: The memory for the next frame.
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
