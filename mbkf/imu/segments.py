"""Which segment a sensor's name means, in the words that different programs use."""

from __future__ import annotations

import re
from collections.abc import Iterable

from mbkf.errors import UnknownName

_WORDS = {
    "pelvis": "pelvis", "hip": "pelvis", "hips": "pelvis", "sacrum": "pelvis", "lumbar": "pelvis",
    "torso": "torso", "chest": "torso", "sternum": "torso", "trunk": "torso", "thorax": "torso", "upperback": "torso",
    "thigh": "thigh", "femur": "thigh", "upperleg": "thigh", "shank": "shank", "tibia": "shank", "lowerleg": "shank",
    "foot": "foot", "calcn": "foot", "talus": "foot", "head": "head", "upperarm": "upper_arm", "humerus": "upper_arm",
    "forearm": "forearm", "lowerarm": "forearm", "radius": "forearm", "hand": "hand",
}  # fmt: skip
_SIDES = {"right": "right", "r": "right", "left": "left", "l": "left"}
_PAIRED = ("thigh", "shank", "foot", "upper_arm", "forearm", "hand")


def segment_of(name: str, segments: Iterable[str]) -> str:
    """The body's segment that a sensor called ``name`` sits on: "femur_r", "Left Foot", "upper_leg_left".

    Raises:
        UnknownName: None of them.
    """
    known = tuple(segments)
    if name in known:
        return name
    words = [word for word in re.split(r"[^a-z]+", re.sub(r"([a-z])([A-Z])", r"\1 \2", name).lower()) if word]
    words = [word for word in words if word not in ("imu", "sensor", "the")]
    side = next((_SIDES[word] for word in words if word in _SIDES), "")
    part = _WORDS.get("".join(word for word in words if word not in _SIDES), "")
    found = f"{side}_{part}" if part in _PAIRED and side else part
    if found not in known:
        raise UnknownName("segment of sensor", name, known)
    return found
