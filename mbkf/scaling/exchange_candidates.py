"""Exchanges of names that are tried on a standing person: pairs, pairs on both sides alike, limbs of both sides."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import combinations

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import ProtocolMarker
from mbkf.model.sides import mirrored
from mbkf.numerics.elimination import Indices
from mbkf.scaling.partners import partners


class Candidates:
    """Orders in which the names of M markers may have been given.

    Attributes:
        pairs: (n, M) with two markers exchanged, or the same two on both sides. Two technical markers of a segment are
            not exchanged: their places are learnt from the trial whichever names they have.
        arms: Those of them on segments of arms, which people turn about their long axes: fitted in any case.
        limbs: Orders (M,) with the markers of both sides exchanged on some segments.
        sides: Pairs of corresponding markers of both sides.
    """

    def __init__(self, body: BodyDescription, markers: Sequence[ProtocolMarker], seen: BoolArray) -> None:
        """The candidates.

        Args:
            body: The reference body.
            markers: The M markers.
            seen: (M,) True for those that the frame shows.
        """
        other = partners(markers)
        other = np.where(seen & seen[other], other, np.arange(len(markers))).astype(np.intp)
        self.sides = [(m, int(one)) for m, one in enumerate(other) if one > m]
        named = [m for m, one in enumerate(markers) if seen[m] and one.kind != "computed"]
        found: list[tuple[tuple[int, int], ...]] = []
        for a, b in combinations(named, 2):
            same = markers[a].segment == markers[b].segment
            if same and markers[a].kind == markers[b].kind == "technical":
                continue
            found.append(((a, b),))
            both = ((a, b), (int(other[a]), int(other[b])))
            if same and len({a, b, *both[1]}) == 4 and a < other[a]:
                found.append(both)
        self.pairs = np.array([exchanged(len(markers), one) for one in found], dtype=np.intp)
        turning = _arms(body)
        self.arms = [
            order
            for order, ((a, b), *_) in zip(self.pairs, found, strict=True)
            if markers[a].segment == markers[b].segment and markers[a].segment in turning
            if "technical" not in {markers[a].kind, markers[b].kind}
        ]
        self.limbs = _limbs(body, markers, other)


def exchanged(count: int, pairs: Sequence[tuple[int, int]]) -> Indices:
    """(M,) order of M markers after exchanges of pairs, one after the other."""
    order = np.arange(count)
    for a, b in pairs:
        order[[a, b]] = order[[b, a]]
    return order


def _limbs(body: BodyDescription, markers: Sequence[ProtocolMarker], other: Indices) -> list[Indices]:
    """Orders with both sides exchanged: on a segment, on it and all beyond, everywhere, on or off the legs."""
    every = {segment.name for segment in body.segments}
    groups: list[Collection[str]] = []
    for segment in body.segments:
        if not segment.name.startswith("left_"):
            groups += [_beyond(body, segment.name), {segment.name}]
    below = _legs(body)
    groups += [every, {*below, body.roles.root}, every - below, every - {body.roles.root}]
    found: dict[bytes, Indices] = {}
    for group in groups:
        both = {*group, *(mirrored(name) for name in group)}
        on = np.array([marker.segment in both for marker in markers])
        order = np.where(on, other, np.arange(len(markers)))
        if (order != np.arange(len(markers))).any():
            found.setdefault(order.tobytes(), order)
    return list(found.values())


def _legs(body: BodyDescription) -> set[str]:
    """The segments of both legs."""
    return {name for foot in body.roles.feet for name in _above(body, foot)}


def _arms(body: BodyDescription) -> set[str]:
    """The segments of both arms."""
    sided = {segment.name for segment in body.segments if mirrored(segment.name) != segment.name}
    return sided - _legs(body)


def _beyond(body: BodyDescription, first: str) -> set[str]:
    """A segment and all that hang on it."""
    found = {first}
    for segment in body.segments:  # parents come first
        if segment.parent in found:
            found.add(segment.name)
    return found


def _above(body: BodyDescription, foot: str) -> set[str]:
    """The segments of a leg: from its foot up to the root, without it, and toes."""
    found, proximal = _beyond(body, foot), {foot}
    for segment in reversed(body.segments):  # parents come first
        if segment.name in proximal and segment.name != body.roles.root and segment.parent:
            found.add(segment.name)
            proximal.add(segment.parent)
    return found
