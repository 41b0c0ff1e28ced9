"""Parts of a body that carry markers, in words."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from mbkf.marker_sets.names import NameReading
from mbkf.model.description import Roles

PARTS = {
    "head": ("head", "neck"),
    "trunk": ("torso",),
    "pelvis": ("pelvis",),
    "arm": ("upper_arm", "forearm"),
    "hand": ("hand",),
    "leg": ("thigh", "shank"),
    "foot": ("foot", "toes"),
}
"""Segments of the parts, by the end of their names."""

PLURAL = {"arm": "arms", "hand": "hands", "leg": "legs", "foot": "feet"}
"""Names of both sides of a part."""

MISREAD = 0.1
"""Share of names that may be misread."""

MOSTLY = 0.5
"""Probability from which a name means a segment."""


def segments_named(readings: Mapping[str, NameReading]) -> dict[str, int]:
    """Number of the markers whose names mean each segment.

    Args:
        readings: Readings of the names, by name.
    """
    counts: dict[str, int] = {}
    for one in readings.values():
        odds: dict[str, float] = {}
        for place in one.places if one.kind in ("marker", "keypoint") else ():
            odds[place.segment] = odds.get(place.segment, 0.0) + place.probability
        best = max(odds, key=lambda segment: odds[segment], default="")
        if best and odds[best] >= MOSTLY:
            counts[best] = counts.get(best, 0) + 1
    return counts


def parts_in_words(segments: Collection[str]) -> tuple[str, str]:
    """Parts of a body with markers on some of its segments, as "trunk, right arm", and the parts without."""
    seen, bare = [], []
    for part, ends in PARTS.items():
        both = PLURAL.get(part, part)
        sides = [side for side in ("right", "left") if any(f"{side}_{end}" in segments for end in ends)]
        if len(sides) == 2 or any(end in segments for end in ends):
            seen.append(both)
        elif sides:
            seen.append(f"{sides[0]} {part}")
        else:
            bare.append(both)
    return ", ".join(seen), ", ".join(bare)


def upper_body_only(markers: Mapping[str, int], roles: Roles) -> dict[str, int]:
    """The number of markers by segment of the upper body alone, empty where pelvis, legs or feet carry some as well.

    The lower body has to carry markers: head and hands are small, and arms move too freely about the trunk.

    Args:
        markers: Number of markers by segment; a few of the lower body may be misread names.
        roles: Roles of the body's segments.
    """
    lower = roles.lower_body
    upper = {segment: count for segment, count in markers.items() if segment not in lower}
    return upper if sum(upper.values()) >= (1.0 - MISREAD) * sum(markers.values()) else {}
