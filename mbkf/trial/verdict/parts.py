"""The parts of a body that are judged, and the segments that belong to each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mbkf.io.verdict import MOTION_PARTS
from mbkf.model.description import BodyDescription

PELVIS, TRUNK, RIGHT_LEG, LEFT_LEG, RIGHT_ARM, LEFT_ARM = MOTION_PARTS
LEGS, ARMS = (RIGHT_LEG, LEFT_LEG), (RIGHT_ARM, LEFT_ARM)


def part_of_segment(body: BodyDescription) -> dict[str, str]:
    """The part of each segment: root, legs from the root to the toes, arms by their side, all others the trunk."""
    roles = body.roles
    legs = {*roles.legs, *roles.feet, *roles.toes}
    found = {}
    for one in body.segments:
        side = 1 if one.name.startswith("left_") else 0
        sided = side == 1 or one.name.startswith("right_")
        limb = LEGS[side] if one.name in legs else ARMS[side]
        found[one.name] = PELVIS if one.name == roles.root else limb if sided else TRUNK
    return found


def main_segments(body: BodyDescription) -> Mapping[str, tuple[str, ...]]:
    """Segments by part that a motion of the part needs: those that carry others, and the feet."""
    carrying = {one.parent for one in body.segments} | set(body.roles.feet)
    part = part_of_segment(body)
    above = _above(body)
    return {
        each: tuple(
            name
            for name, belongs in part.items()
            if belongs == each and name in carrying and (each != TRUNK or above[name] == body.roles.root)
        )
        for each in MOTION_PARTS
    }


def _above(body: BodyDescription) -> dict[str, str]:
    return {one.name: one.parent for one in body.segments}


def markers_of_part(body: BodyDescription, segments: Iterable[str]) -> dict[str, list[int]]:
    """Places of markers by part.

    Args:
        body: The body.
        segments: (M,) segment that carries each marker.
    """
    part = part_of_segment(body)
    found: dict[str, list[int]] = {each: [] for each in MOTION_PARTS}
    for m, segment in enumerate(segments):
        found[part[segment]].append(m)
    return found
