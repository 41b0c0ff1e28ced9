"""A colour for each segment of a body: neighbours differ, and the left one is lighter than the right."""

from __future__ import annotations

from collections.abc import Iterable

from mbkf.model.sides import mirrored

HUES = {
    "pelvis": ("#1f2a44", "#1f2a44"),
    "torso": ("#2a9d8f", "#2a9d8f"),
    "neck": ("#8d6e63", "#8d6e63"),
    "head": ("#6a4c93", "#6a4c93"),
    "upper_arm": ("#c2185b", "#f06292"),
    "forearm": ("#e08b00", "#f5bd47"),
    "hand": ("#5d4037", "#a1887f"),
    "thigh": ("#1565c0", "#64a8ef"),
    "shank": ("#b23a12", "#f08a5d"),
    "foot": ("#2e7d32", "#81c784"),
    "toes": ("#7b1fa2", "#ba8fd6"),
}
"""Colours of the right (or only) and the left segment."""

OTHERS = ("#00838f", "#ad1457", "#558b2f", "#4527a0", "#ef6c00", "#37474f", "#0277bd", "#9e9d24")
"""Colours of segments with other names, in turn."""


def segment_colours(segments: Iterable[str]) -> dict[str, str]:
    """Colour by segment, in CSS."""
    found: dict[str, str] = {}
    spare = 0
    for name in segments:
        left = name != mirrored(name) and name.startswith("left_")
        plain = name.removeprefix("left_").removeprefix("right_")
        if plain in HUES:
            found[name] = HUES[plain][left]
        else:
            found[name] = OTHERS[spare % len(OTHERS)]
            spare += 1
    return found
