"""Records of foot contact: what each foot stands on, and what the decision carries from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from math import inf
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.kernel.contact import HEAD, NEVER, PER_PLATE
from mbkf.numerics.running_median import RunningMedian
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

    def unpacked(self) -> ContactMemory:
        """Itself."""
        return self

    def packed(self, window: int) -> PackedMemory:
        """The same as one array of numbers, for a movement of at most so many frames.

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
        numbers: They, in the order of :mod:`mbkf.kernel.contact`.
        plates: Number of plates.
        window: Frames of movement that there is room for.
    """

    numbers: Array
    plates: int
    window: int

    @property
    def foot_of_plate(self) -> tuple[int, ...]:
        """(K,) as that of :class:`ContactMemory`."""
        return tuple(int(foot) for foot in self._of_plates()[:, 0])

    def unpacked(self) -> ContactMemory:
        """What it holds."""
        height, right_s, left_s, right_m, left_m, airborne, *counts = self.numbers[:HEAD].tolist()
        frames, *ranked = (int(count) for count in counts)
        series = self.numbers[HEAD + PER_PLATE * self.plates :].reshape(7, self.window)
        low_x, low_y = (
            RunningMedian(tuple(latest[:frames].tolist()), order[:count].tolist())
            for latest, order, count in zip(series[:4:2], series[1:4:2], ranked, strict=True)
        )
        path = series[4:].reshape(self.window, 3)[:frames].tolist()
        return ContactMemory(
            self.foot_of_plate,
            tuple(
                None if owner == NEVER else Pressed(x, y, int(owner))
                for _, x, y, owner in self._of_plates().tolist()
            ),
            height,
            (right_s, left_s),
            Movement((low_x, low_y), tuple((x, y, z) for x, y, z in path), int(airborne)),
            (right_m, left_m),
        )

    def _of_plates(self) -> Array:
        return self.numbers[HEAD : HEAD + PER_PLATE * self.plates].reshape(self.plates, PER_PLATE)


KeptContact = ContactMemory | PackedMemory
"""What a decision needs from the frame before, in either form."""


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
    memory: KeptContact
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
