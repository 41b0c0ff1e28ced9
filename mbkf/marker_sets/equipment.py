"""Parts of a person that carry markers: the sets of segments that laboratories equip, and the frequency of each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.marker_sets.places import WornPlaces


@dataclass(frozen=True)
class Equipment:
    """A part of the body that carries markers.

    Attributes:
        name: Its name in messages.
        without: Segments without markers, by the end of their names ("hand" is both hands).
        share: Share of the laboratories that equip exactly this part.
        top_m: Possible heights of its highest marker on the standing reference body.
        bottom_m: Height of its lowest marker.
    """

    name: str
    without: tuple[str, ...]
    share: float
    top_m: tuple[float, ...]
    bottom_m: float = 0.03

    def bare(self, places: WornPlaces) -> BoolArray:
        """(C,) True for components on segments without markers."""
        return np.array([segment.endswith(self.without) for segment in places.segments], dtype=bool)


_ARMS = ("upper_arm", "forearm", "hand")
_HEAD = ("head", "neck")
_LEGS = ("thigh", "shank", "foot", "toes")
_LEFT_ARM, _RIGHT_ARM = (tuple(f"{side}_{part}" for part in _ARMS) for side in ("left", "right"))

FEWEST = {"head": 3, "torso": 2, "pelvis": 3, "upper_arm": 1, "forearm": 1, "thigh": 2, "shank": 2, "foot": 2}
"""Least number of markers on an equipped segment, by the end of its name; neck, hands and toes may have none."""

LACKING = 0.1
"""Probability of each marker missing from that number: it fell off, or is hidden."""

UNPAIRED = 0.3
"""Probability of each marker of a limb in excess of the other side's."""

EQUIPMENTS = (
    Equipment("the whole body", (), 0.38, (1.80, 1.68)),
    Equipment("the body without the head", _HEAD, 0.18, (1.47,)),
    Equipment("head, trunk and legs", _ARMS, 0.06, (1.80, 1.68)),
    Equipment("trunk and legs", (*_ARMS, *_HEAD), 0.10, (1.47, 1.35)),
    Equipment("pelvis and legs", (*_ARMS, *_HEAD, "torso"), 0.19, (1.08, 1.02)),
    Equipment("the upper body", _LEGS, 0.04, (1.80, 1.68), 0.83),
    Equipment("trunk and arms", (*_LEGS, *_HEAD), 0.02, (1.47,), 0.83),
    Equipment("trunk and right arm", (*_LEGS, *_HEAD, *_LEFT_ARM), 0.01, (1.47,), 0.83),
    Equipment("trunk and left arm", (*_LEGS, *_HEAD, *_RIGHT_ARM), 0.01, (1.47,), 0.83),
    Equipment("head, trunk and right arm", (*_LEGS, *_LEFT_ARM), 0.005, (1.80, 1.68), 0.83),
    Equipment("head, trunk and left arm", (*_LEGS, *_RIGHT_ARM), 0.005, (1.80, 1.68), 0.83),
)


def equipped_weight(places: WornPlaces, equipment: Equipment) -> Array:
    """(C,) weights of the components where only these segments carry markers; they sum to 1."""
    weight = np.where(equipment.bare(places), 0.0, places.weight)
    return np.asarray(weight / weight.sum())


def count_log_probability(places: WornPlaces, equipment: Equipment, shares: Array) -> float:
    """Logarithm of the probability of the numbers of markers on an equipment's segments.

    Laboratories put a few on every segment, and as many on the left as on the right. Without this term a child's whole
    body explains the markers of a man's legs nearly as well as his legs do, and an arm those of the lower back.

    Args:
        places: Density of marker places.
        equipment: The part of the body that carries them.
        shares: (N, C) shares of the points in the components.
    """
    each = np.bincount(places.segment_index, shares.sum(axis=0), len(places.body.segments))
    count = {
        segment.name: float(markers)
        for segment, markers in zip(places.body.segments, each, strict=True)
        if not segment.name.endswith(equipment.without)
    }
    lacking = sum(
        max(0.0, FEWEST.get(name.removeprefix("right_").removeprefix("left_"), 0) - markers)
        for name, markers in count.items()
    )
    unpaired = 0.0
    for limb in (_ARMS, _LEGS):
        right, left = ([count.get(f"{side}_{part}") for part in limb] for side in ("right", "left"))
        if None not in (right[0], left[0]):
            unpaired += abs(sum(filter(None, right)) - sum(filter(None, left)))
    return lacking * math.log(LACKING) + unpaired * math.log(UNPAIRED)
