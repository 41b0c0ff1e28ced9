"""Density of marker places on a body, from landmarks, known sets and the skin.

The density is a mixture of Gaussian components, each fixed to a segment of the reference body:

* its landmarks;
* the places of the markers of the shipped protocols, each weighted by the number of protocols that use it;
* a grid over the skin of the segments' shapes, for clusters and other markers of free placement.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.model.description import BodyDescription, SegmentShape
from mbkf.model.protocol import DEFAULT_NOISE_M, ProtocolMarker, load_protocol, protocol_names

SAME_PLACE_M = 0.012
"""Distance below which two places of a segment are one."""

LANDMARK_SD_M = 0.012
"""Spread of a marker about its landmark, per coordinate (1 sd)."""

WIDEST_SD_M = 0.035
"""Greatest spread of a technical marker about its place in a protocol."""

SKIN_SD_M = 0.030
"""Spread of the components of the skin, about their distance."""

SKIN_ABOVE_M = 0.012
"""Height of a marker's centre above the skin."""

SKIN_SHARE = 0.25
"""Share of a segment's density that is spread over its skin."""

UNUSED_LANDMARK = 0.3
"""Weight of a landmark that no protocol uses, over that of one that a single protocol uses."""

_LEVELS = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85)
_AZIMUTHS = np.arange(8) * np.pi / 4.0


@dataclass(frozen=True, eq=False)
class WornPlaces:
    """The C components of the density.

    Attributes:
        body: The reference body.
        segments: (C,) segment of each.
        position_m: (C, 3) its centre in the segment's frame.
        landmarks: (C,) its landmark, "" for others.
        sd_m: (C,) its spread per coordinate.
        weight: (C,) its share; they sum to 1.
        noise_m: (C,) noise of a marker there, mostly movement of the skin, per coordinate.
    """

    body: BodyDescription
    segments: tuple[str, ...]
    position_m: Array
    landmarks: tuple[str, ...]
    sd_m: Array
    weight: Array
    noise_m: Array

    @cached_property
    def segment_index(self) -> NDArray[np.intp]:
        """(C,) place of each component's segment among the body's."""
        place = {segment.name: k for k, segment in enumerate(self.body.segments)}
        index = np.array([place[name] for name in self.segments], dtype=np.intp)
        index.setflags(write=False)
        return index

    def only(self, components: BoolArray) -> WornPlaces:
        """Some of the components, (C,) True; their weights then sum to less than 1."""
        kept = np.flatnonzero(components)
        return WornPlaces(
            self.body,
            tuple(self.segments[c] for c in kept),
            read_only(self.position_m[kept]),
            tuple(self.landmarks[c] for c in kept),
            *(read_only(values[kept]) for values in (self.sd_m, self.weight, self.noise_m)),
        )


@dataclass
class _Place:
    segment: str
    position_m: Array
    landmark: str
    sd_m: float
    weight: float
    noise_m: float = 0.0


def worn_places(body: BodyDescription, leave_out: Iterable[str] = ()) -> WornPlaces:
    """The density of marker places on a body.

    Args:
        body: The reference body.
        leave_out: Protocols that do not count, for tests of the density on unknown sets.
    """
    return _worn_places(body, tuple(sorted(leave_out)))


@lru_cache(maxsize=8)
def _worn_places(body: BodyDescription, leave_out: tuple[str, ...]) -> WornPlaces:
    places = [
        _Place(mark.segment, mark.position_m, name, LANDMARK_SD_M, UNUSED_LANDMARK)
        for name, mark in body.landmarks.items()
    ]
    for name in protocol_names():
        if name not in leave_out:
            for marker in load_protocol(name, body).markers:
                if marker.kind in ("anatomical", "technical"):
                    _add(places, marker)
    total = {segment.name: 0.0 for segment in body.segments}
    for place in places:
        total[place.segment] += place.weight
    for segment in body.segments:
        skin = _skin(body, segment.name)
        share = SKIN_SHARE / (1.0 - SKIN_SHARE) * total[segment.name] / max(len(skin), 1)
        places += [_Place(segment.name, point, "", SKIN_SD_M, share) for point in skin]
    _spread_noise(places)
    weight = np.array([place.weight for place in places])
    return WornPlaces(
        body,
        tuple(place.segment for place in places),
        read_only(np.array([place.position_m for place in places])),
        tuple(place.landmark for place in places),
        read_only(np.array([place.sd_m for place in places])),
        read_only(weight / weight.sum()),
        read_only(np.array([place.noise_m for place in places])),
    )


def _add(places: list[_Place], marker: ProtocolMarker) -> None:
    """Adds a protocol's place, or its weight and noise to the same place."""
    near = [
        place
        for place in places
        if place.segment == marker.segment and _distance_m(place, marker.position_m) < SAME_PLACE_M
    ]
    if near:
        nearest = min(near, key=lambda place: _distance_m(place, marker.position_m))
        nearest.weight += 1.0
        nearest.noise_m = max(nearest.noise_m, marker.noise_m)
    else:
        spread = min(marker.placement_sd_m, WIDEST_SD_M)
        places.append(_Place(marker.segment, marker.position_m, "", spread, 1.0, marker.noise_m))


def _spread_noise(places: list[_Place]) -> None:
    """Gives every place without a noise that of the nearest place with one on its segment."""
    known = [place for place in places if place.noise_m]
    for place in places:
        if not place.noise_m:
            own = [other for other in known if other.segment == place.segment]
            nearest = min(own, key=lambda other: _distance_m(other, place.position_m), default=None)
            place.noise_m = DEFAULT_NOISE_M["technical"] if nearest is None else nearest.noise_m


def _distance_m(place: _Place, position_m: Array) -> float:
    return float(np.linalg.norm(place.position_m - position_m))


def _skin(body: BodyDescription, segment: str) -> Array:
    """(n, 3) points just above the skin of a segment's shape; empty where it has no shape of its own."""
    own = body.shapes.get(segment)
    if own is not None:
        return _points(body, own)
    right = body.shapes.get("right_" + segment.removeprefix("left_"))
    points = np.zeros((0, 3)) if right is None else _points(body, right)
    return points * [1.0, -1.0, 1.0] if segment.startswith("left_") else points


def _points(body: BodyDescription, shape: SegmentShape) -> Array:
    circle = np.column_stack([np.cos(_AZIMUTHS), np.sin(_AZIMUTHS)])
    rings = []
    if shape.kind == "limb":
        end = body.segment(shape.to).origin_m
        for level in _LEVELS:
            radius = np.interp(level, [0.0, 1.0], shape.numbers[:2]) + SKIN_ABOVE_M
            rings.append(level * end + np.insert(radius * circle, 2, 0.0, axis=1))
    elif shape.kind == "tube":
        for x, z, depth, breadth in np.reshape(shape.numbers, (-1, 4)):
            if depth > 0.05:
                ring = [x, 0.0] + [depth + SKIN_ABOVE_M, breadth + SKIN_ABOVE_M] * circle
                rings.append(np.insert(ring, 2, z, axis=1))
    elif shape.kind == "ellipsoid":
        centre, axes = shape.numbers[:3], shape.numbers[3:] + SKIN_ABOVE_M
        for height in np.sin([-0.6, 0.0, 0.6, 1.57]):
            rings.append(centre + axes * np.insert(np.sqrt(1 - height**2) * circle, 2, height, axis=1))
    return np.concatenate(rings) if rings else np.zeros((0, 3))
