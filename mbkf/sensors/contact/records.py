"""Records of foot contact: what each foot stands on, and what the decision carries from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from math import inf
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.sensors.contact.floor import NO_MOVEMENT, Movement
from mbkf.sensors.contact.sharing import SharedLoad, Stance


class Contact(IntEnum):
    """What a foot stands on.

    Attributes:
        UNMEASURED: Something that no plate reads; the foot's wrench is unknown, not zero.
        AIR: Nothing; its wrench is zero.
        MEASURED: A plate of its own, which reads its wrench.
        SHARED: One plate together with the other foot; the plate reads the sum of both wrenches.
    """

    UNMEASURED = -1
    AIR = 0
    MEASURED = 1
    SHARED = 2


class Pressed(NamedTuple):
    """A centre of pressure (world x, y in m) and the foot it belongs to (0 right, 1 left, 2 both, -1 none)."""

    x: float
    y: float
    owner: int


@dataclass(frozen=True)
class ContactMemory:
    """What a decision needs from the frame before.

    Attributes:
        foot_of_plate: (K,) 0 right, 1 left, 2 both, -1 none.
        pressed: (K,) last centre of pressure on each plate and its foot; None before the plate was loaded.
        sole_height_m: Height at which the body's loaded soles lie, NaN before one was loaded.
        touching_s: For how long right and left foot have touched the floor without a reading.
        movement: The last frames of the body's movement.
        lowest_ball_m: Least height of right and left ball while the foot has touched the floor.
    """

    foot_of_plate: tuple[int, ...]
    pressed: tuple[Pressed | None, ...]
    sole_height_m: float
    touching_s: tuple[float, float]
    movement: Movement = NO_MOVEMENT
    lowest_ball_m: tuple[float, float] = (inf, inf)


class FreeStance(NamedTuple):
    """Both feet on floor that no plate reads.

    Attributes:
        stance: Where they are expected to be loaded.
        pelvis_m: (3,) the pelvis.
        push_share: Share of the load on right and left foot while it pushes off; None while it does not.
    """

    stance: Stance
    pelvis_m: Array
    push_share: tuple[float | None, float | None] = (None, None)


@dataclass(frozen=True)
class ContactDecision:
    """The contact decision of one frame.

    Attributes:
        contacts: What right and left foot stand on.
        wrench: (2, 6) measured force N and moment N m per foot about the world's origin; of both feet together where
            they share a plate, zero where not measured.
        centres_m: (2, 3) middle of right and left sole, world.
        stray: Whether a loaded plate belongs to no foot.
        memory: For the next frame.
        shared: How the feet share a plate; None where they do not.
        free: Where both feet stand if both carry weight where no plate reads; None else.
        near: How near right and left foot in the air are to touching a floor that no plate reads, 0 to 1.
        floor_m_s: Horizontal velocity of the floor: that of a belt, else zero.
        below: (6,) sum of what plates read below the threshold from which they count as loaded, N, N m about the
            world's origin; None for nothing.
    """

    contacts: tuple[Contact, Contact]
    wrench: Array
    centres_m: Array
    stray: bool
    memory: ContactMemory
    shared: SharedLoad | None = None
    free: FreeStance | None = None
    near: tuple[float, float] = (0.0, 0.0)
    floor_m_s: tuple[float, float] = (0.0, 0.0)
    below: Array | None = None


class Planted(NamedTuple):
    """What stands still: a foot or its toes, its world point (3,) that does not move, and whether it lies flat."""

    segment: str
    point_m: Array
    flat: bool
