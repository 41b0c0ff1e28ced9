"""Which parts of a person carry markers: the sets of segments that laboratories equip, and how common each is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.marker_sets.places import WornPlaces


@dataclass(frozen=True)
class Equipment:
    """A part of the body that carries markers.

    Attributes:
        name: In words, for people.
        without: Segments that carry none, by the end of their names ("hand" is both hands).
        share: How many laboratories equip just this.
        top_m: Heights at which its highest marker may be on the standing reference body.
        bottom_m: The same of its lowest marker.
    """

    name: str
    without: tuple[str, ...]
    share: float
    top_m: tuple[float, ...]
    bottom_m: float = 0.03


_ARMS = ("upper_arm", "forearm", "hand")
_HEAD = ("head", "neck")
_LEGS = ("thigh", "shank", "foot", "toes")

EQUIPMENTS = (
    Equipment("the whole body", (), 0.40, (1.80, 1.68)),
    Equipment("the body without the head", _HEAD, 0.18, (1.47,)),
    Equipment("head, trunk and legs", _ARMS, 0.06, (1.80, 1.68)),
    Equipment("trunk and legs", (*_ARMS, *_HEAD), 0.10, (1.47, 1.35)),
    Equipment("pelvis and legs", (*_ARMS, *_HEAD, "torso"), 0.20, (1.08, 1.02)),
    Equipment("the upper body", _LEGS, 0.04, (1.80, 1.68), 0.75),
    Equipment("trunk and arms", (*_LEGS, *_HEAD), 0.02, (1.47,), 0.75),
)


def equipped_weight(places: WornPlaces, equipment: Equipment) -> Array:
    """(C,) shares of the components where only these segments carry markers; they sum to 1."""
    bare = np.array([segment.endswith(equipment.without) for segment in places.segments])
    weight = np.where(bare, 0.0, places.weight)
    return np.asarray(weight / weight.sum())
