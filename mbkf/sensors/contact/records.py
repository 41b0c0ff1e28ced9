"""Records of foot contact: the contact of each foot, and the state that decisions carry from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import inf
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.kernel.contact import HEAD, NEVER, PER_PLATE
from mbkf.sensors.contact.floor import NO_MOVEMENT, Movement
from mbkf.sensors.contact.sharing import SharedLoad, Stance


class Contact(IntEnum):
    """Contact of a foot.

    Attributes:
        UNMEASURED: It stands where no plate reads; its wrench is unknown, not zero.
        AIR: It stands on nothing; its wrench is zero.
        MEASURED: It stands on a plate of its own, which reads its wrench.
        SHARED: It stands on one plate with the other foot; the plate reads the sum of both wrenches.
    """

    UNMEASURED = -1
    AIR = 0
    MEASURED = 1
    SHARED = 2


def unread(contacts: Sequence[Contact]) -> bool:
    """True where feet bear and no plate reads any of them."""
    return Contact.UNMEASURED in contacts and not {Contact.MEASURED, Contact.SHARED} & set(contacts)


class Pressed(NamedTuple):
    """A centre of pressure (world x, y in m) and its owner as in :mod:`mbkf.sensors.contact.rules`."""

    x: float
    y: float
    owner: int


@dataclass(frozen=True)
class ContactMemory:
    """State that a decision takes over from the frame before.

    Attributes:
        foot_of_plate: (K,) 0 right, 1 left, 2 both, -1 neither.
        pressed: (K,) last centre of pressure on each plate and its foot; None before the plate was loaded.
        sole_height_m: Height at which the body's loaded soles lie, NaN before one was loaded.
        touching_s: Duration for which right and left foot have touched the floor without a reading.
        movement: The last frames of the body's movement.
        lowest_ball_m: Least height of right and left ball while the foot has touched the floor.
    """

    foot_of_plate: tuple[int, ...]
    pressed: tuple[Pressed | None, ...]
    sole_height_m: float
    touching_s: tuple[float, float]
    movement: Movement = NO_MOVEMENT
    lowest_ball_m: tuple[float, float] = (inf, inf)

    def packed(self, window: int) -> PackedMemory:
        """The memory as one array of numbers, for a movement of at most ``window`` frames.

        Raises:
            ValueError: The movement is longer.
        """
        plates, movement = len(self.foot_of_plate), self.movement
        numbers = np.zeros(HEAD + PER_PLATE * plates + 7 * window)
        ranked = [low.ranked for low in movement.low_m_s]
        numbers[:HEAD] = [
            self.sole_height_m,
            *self.touching_s,
            *self.lowest_ball_m,
            movement.airborne,
            len(movement.pelvis_m),
            *(len(order) for order in ranked),
        ]
        of_plate = numbers[HEAD : HEAD + PER_PLATE * plates].reshape(plates, PER_PLATE)
        for own, foot, pressed in zip(of_plate, self.foot_of_plate, self.pressed, strict=True):
            own[:] = foot, *(pressed or (0.0, 0.0, NEVER))
        at = HEAD + PER_PLATE * plates
        for low in movement.low_m_s:
            for part in (low.latest, low.ranked):
                numbers[at : at + window][: len(part)] = part
                at += window
        numbers[at:].reshape(window, 3)[: len(movement.pelvis_m)] = movement.pelvis_m or np.zeros((0, 3))
        return PackedMemory(read_only(numbers), plates, window)


class PackedMemory(NamedTuple):
    """A :class:`ContactMemory` as the compiled decision keeps it.

    Attributes:
        numbers: Its numbers, in the order of :mod:`mbkf.kernel.contact`.
        plates: Number of plates.
        window: Number of frames of movement for which it has room.
    """

    numbers: Array
    plates: int
    window: int

    @property
    def foot_of_plate(self) -> tuple[int, ...]:
        """(K,) as in :class:`ContactMemory`."""
        return tuple(int(foot) for foot in self.numbers[HEAD : HEAD + PER_PLATE * self.plates : PER_PLATE])


KeptContact = ContactMemory | PackedMemory
"""State that a decision takes over from the frame before, of the Python or of the compiled decision."""


class FreeStance(NamedTuple):
    """Both feet on floor that no plate reads.

    Attributes:
        stance: Points at which they are expected to be loaded.
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
        contacts: Contact of right and left foot.
        wrench: (2, 6) measured force N and moment N m per foot about the world's origin; of both feet together where
            they share a plate, zero where not measured.
        centres_m: (2, 3) middle of right and left sole, world.
        stray: True if a loaded plate belongs to no foot.
        memory: State for the next frame.
        shared: The load of a plate on which both feet stand, shared between them; None where they do not.
        free: Stance of both feet if both carry weight where no plate reads; None else.
        near: Nearness, 0 to 1, of right and left foot in the air to touching a floor that no plate reads.
        floor_m_s: Horizontal velocity of the floor: that of a belt, else zero.
        below: (6,) sum of readings below the threshold from which plates count as loaded, N, N m about the world's
            origin; None without such a reading.
    """

    contacts: tuple[Contact, Contact]
    wrench: Array
    centres_m: Array
    stray: bool
    memory: KeptContact
    shared: SharedLoad | None = None
    free: FreeStance | None = None
    near: tuple[float, float] = (0.0, 0.0)
    floor_m_s: tuple[float, float] = (0.0, 0.0)
    below: Array | None = None


class Planted(NamedTuple):
    """A foot or its toes at rest on the floor: the world point (3,) that does not move; True if the sole lies flat."""

    segment: str
    point_m: Array
    flat: bool
