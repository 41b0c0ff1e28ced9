"""Exchanges of names that a static trial is spoilt with: within a limb, across sides, anywhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.model.sides import mirrored
from mbkf.scaling.partners import partners

NEAR_M = 0.03
"""Greatest distance of a marker from the landmark that it counts for."""

PAIRS: Mapping[str, Sequence[tuple[str, str]]] = {
    "inner and outer knee": [("right_knee_lateral", "right_knee_medial")],
    "inner and outer left knee": [("left_knee_lateral", "left_knee_medial")],
    "inner and outer knees": [
        ("right_knee_lateral", "right_knee_medial"),
        ("left_knee_lateral", "left_knee_medial"),
    ],
    "inner and outer ankle": [("right_ankle_lateral", "right_ankle_medial")],
    "inner and outer wrist": [("right_wrist_radial", "right_wrist_ulnar")],
    "inner and outer wrists": [
        ("right_wrist_radial", "right_wrist_ulnar"),
        ("left_wrist_radial", "left_wrist_ulnar"),
    ],
    "inner and outer elbow": [("right_elbow_lateral", "right_elbow_medial")],
    "outer knee and ankle": [("right_knee_lateral", "right_ankle_lateral")],
    "inner left knee and ankle": [("left_knee_medial", "left_ankle_medial")],
    "outer knees": [("right_knee_lateral", "left_knee_lateral")],
    "outer ankles": [("right_ankle_lateral", "left_ankle_lateral")],
    "heels": [("right_heel", "left_heel")],
    "front of the pelvis": [("right_asis", "left_asis")],
    "back of the pelvis": [("right_psis", "left_psis")],
    "front and back of the pelvis, right": [("right_asis", "right_psis")],
    "front and back of the pelvis": [("right_asis", "right_psis"), ("left_asis", "left_psis")],
    "heel and toe": [("right_heel", "right_metatarsal_2")],
    "heel and little toe": [("right_heel", "right_metatarsal_5")],
    "both sides of the forefoot": [("right_metatarsal_1", "right_metatarsal_5")],
    "shoulders": [("right_acromion", "left_acromion")],
    "shoulder and elbow": [("right_acromion", "right_elbow_lateral")],
    "wrists": [("right_wrist_radial", "left_wrist_radial")],
}
"""Pairs of landmarks by exchange."""

LIMBS = {
    "legs": ("thigh", "shank", "foot", "toes"),
    "lower legs": ("shank", "foot", "toes"),
    "feet": ("foot", "toes"),
    "arms": ("upper_arm", "forearm", "hand"),
    "forearms": ("forearm", "hand"),
}
"""Segments of limbs whose sides are exchanged; besides them the pelvis, and everything."""

RANDOM = 4
"""Random pairs, half of them anatomical markers."""


def crossings(protocol: Protocol, markers: Sequence[ProtocolMarker], seed: int) -> dict[str, list[int]]:
    """Orders of M markers by the name of the exchange.

    Args:
        protocol: The protocol.
        markers: Those that the static trial shows.
        seed: Of the random pairs.
    """
    found: dict[str, list[int]] = {}
    for name, pairs in PAIRS.items():
        places = [tuple(_at(protocol, markers, landmark) for landmark in pair) for pair in pairs]
        if all(a is not None and b is not None and a != b for a, b in places):
            found[name] = _order(len(markers), places)
    other = partners(markers)
    every = {segment.name for segment in protocol.body.segments}
    sided = {name: {f"right_{one}" for one in segments} for name, segments in LIMBS.items()}
    for name, segments in {**sided, "pelvis": {protocol.body.roles.root}, "everything": every}.items():
        both = segments | {mirrored(one) for one in segments}
        order = [int(other[m]) if one.segment in both else m for m, one in enumerate(markers)]
        if order != list(range(len(markers))):
            found[f"sides of {name}"] = order
    rng = np.random.default_rng(seed)
    worn = [m for m, one in enumerate(markers) if one.kind != "computed"]
    palpable = [m for m in worn if markers[m].kind == "anatomical"]
    for k in range(RANDOM):
        among = worn if k % 2 or len(palpable) < 3 else palpable
        a, b = (int(one) for one in rng.choice(among, 2, replace=False))
        learnt = (
            markers[a].segment == markers[b].segment and markers[a].kind == markers[b].kind == "technical"
        )
        if not learnt:
            found[f"{markers[a].name} and {markers[b].name}"] = _order(len(markers), [(a, b)])
    return found


def _at(protocol: Protocol, markers: Sequence[ProtocolMarker], name: str) -> int | None:
    """The marker on a landmark, or near it."""
    own = [m for m, one in enumerate(markers) if one.landmark == name and one.kind != "computed"]
    if own or name not in protocol.body.landmarks:
        return own[0] if own else None
    landmark = protocol.body.landmark(name)
    near = [
        (float(np.linalg.norm(one.position_m - landmark.position_m)), m)
        for m, one in enumerate(markers)
        if one.segment == landmark.segment and one.kind != "computed"
    ]
    return min(near)[1] if near and min(near)[0] < NEAR_M else None


def _order(count: int, pairs: Sequence[tuple[int | None, ...]]) -> list[int]:
    order = list(range(count))
    for a, b in pairs:
        assert a is not None and b is not None
        order[a], order[b] = order[b], order[a]
    return order
