"""Records of foot contact: what each foot stands on, and what the decision carries from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from mbkf.conventions import Array


class Contact(IntEnum):
    """What a foot stands on."""

    UNMEASURED = -1
    AIR = 0
    MEASURED = 1
    SHARED = 2


class Pressed(NamedTuple):
    """A centre of pressure (world x, y in m) and its foot (0 right, 1 left, 2 both, -1 nobody)."""

    x: float
    y: float
    owner: int


@dataclass(frozen=True)
class ContactMemory:
    """What a decision remembers from the frame before.

    Attributes:
        foot_of_plate: (K,) 0 right, 1 left, 2 both, -1 nobody.
        pressed: (K,) last centre of pressure on each plate and the foot it belonged to, or None.
        sole_height_m: Height of a loaded sole point of our body, NaN before one was loaded.
        touching_s: For how long right and left foot have touched the floor without a reading.
    """

    foot_of_plate: tuple[int, ...]
    pressed: tuple[Pressed | None, ...]
    sole_height_m: float
    touching_s: tuple[float, float]


@dataclass(frozen=True)
class ContactDecision:
    """A frame's decision.

    Attributes:
        contacts: What right and left foot stand on.
        wrench: (2, 6) measured wrench per foot about the world's origin (of both together where shared).
        centres_m: (2, 3) middle of right and left sole.
        stray: Whether a loaded plate belongs to no foot.
        memory: For the next frame.
    """

    contacts: tuple[Contact, Contact]
    wrench: Array
    centres_m: Array
    stray: bool
    memory: ContactMemory
