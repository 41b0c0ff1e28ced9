"""Names of curves in norms of other tools: the coordinate that they mean, and the sense in which they are positive.

Outputs of Plug-in Gait ("HipAngles" with the component X) and variables of Vicon's GCD files have fixed meanings.
Other names are read by their words: a joint, a plane, and the direction that is positive: of "Hip Flex/Extension" the
first one. The moment of "Hip Ext/Flexion" has two directions and states no sense, since tools use such names for
either; "external knee adduction moment" and "hip extensor moment" state one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

ANGLE, TORQUE, POWER, REACTION = "angle", "torque", "power", "reaction"

INTERNAL, EXTERNAL = "internal", "external"


@dataclass(frozen=True)
class NamedCurve:
    """Meaning of a name.

    Attributes:
        quantity: "angle", "torque", "power" or "reaction".
        name: The coordinate without its side, the joint of a power, or the component of a reaction.
        sense: 1 where positive is flexion, adduction, internal rotation, forward or upward, -1 for the opposite; of a
            torque, 1 for a moment towards these; None where the name states no direction.
        frame: "internal" or "external" where the name of a torque states it; else empty.
    """

    quantity: str
    name: str
    sense: int | None = None
    frame: str = ""


PLANES: dict[str, tuple[str, ...]] = {
    "Pelvis": ("pelvis_tilt", "pelvis_list", "pelvis_rotation"),
    "Trunk": ("trunk_tilt", "trunk_obliquity", "trunk_rotation"),
    "Hip": ("hip_flexion", "hip_adduction", "hip_rotation"),
    "Knee": ("knee_angle", "knee_adduction", "knee_rotation"),
    "Ankle": ("ankle_angle", "", "ankle_rotation"),
    "FootProgress": ("", "", "foot_progression"),
}
"""Coordinates of each joint in the sagittal, frontal and transverse plane; empty where mbkf has no such curve."""

_OUTPUTS = {"Pelvis": "Pelvis", "Thorax": "Trunk", "Hip": "Hip", "Knee": "Knee", "Ankle": "Ankle"}
_OUTPUTS |= dict.fromkeys(("FootProgress", "Foot"), "FootProgress")
_OUTPUT = re.compile(rf"[LR]?({'|'.join(_OUTPUTS)})(Angle|Moment|Power)s?")

GCD_VARIABLES = {
    "PelvicTilt": ("PelvisAngles", "X"), "PelvicObliquity": ("PelvisAngles", "Y"),
    "PelvicRotation": ("PelvisAngles", "Z"), "HipFlexExt": ("HipAngles", "X"),
    "HipAbAdduct": ("HipAngles", "Y"), "HipRotation": ("HipAngles", "Z"),
    "KneeFlexExt": ("KneeAngles", "X"), "KneeValgVar": ("KneeAngles", "Y"),
    "KneeRotation": ("KneeAngles", "Z"), "DorsiPlanFlex": ("AnkleAngles", "X"),
    "FootRotation": ("AnkleAngles", "Z"), "FootProgression": ("FootProgressAngles", "Z"),
    "HipFlexExtMoment": ("HipMoment", "X"), "HipAbAdductMoment": ("HipMoment", "Y"),
    "HipRotationMoment": ("HipMoment", "Z"), "KneeFlexExtMoment": ("KneeMoment", "X"),
    "KneeValgVarMoment": ("KneeMoment", "Y"), "KneeRotationMoment": ("KneeMoment", "Z"),
    "DorsiPlanFlexMoment": ("AnkleMoment", "X"), "HipPower": ("HipPower", ""),
    "KneePower": ("KneePower", ""), "AnklePower": ("AnklePower", ""),
}  # fmt: skip
"""Outputs of Plug-in Gait behind the variables of Vicon Clinical Manager's GCD files."""

_JOINTS = {
    **dict.fromkeys(("pelvis", "pelvic"), "Pelvis"),
    **dict.fromkeys(("trunk", "thorax", "thoracic"), "Trunk"),
    "hip": "Hip",
    "knee": "Knee",
    **dict.fromkeys(("ankle", "plantarflexor", "dorsiflexor"), "Ankle"),
    "foot": "FootProgress",
}
_SAGITTAL = {
    **dict.fromkeys(("flexion", "flex", "flx", "flexor", "dorsi", "dor", "dorsiflexion", "dorsiflexor"), 1),
    **dict.fromkeys(("ant", "anterior", "forward"), 1),
    **dict.fromkeys(
        ("extension", "extensor", "plantar", "pla", "plan", "plantarflexion", "plantarflexor"), -1
    ),
    **dict.fromkeys(("post", "pst", "posterior", "backward"), -1),
}
_FRONTAL = {
    **dict.fromkeys(("adduction", "add", "ad", "adductor", "adduct", "varus", "var", "up", "upward"), 1),
    **dict.fromkeys(("abduction", "abd", "ab", "abductor", "abduct", "valgus", "valg", "down", "dn"), -1),
}
_TRANSVERSE = {
    **dict.fromkeys(("internal", "int", "inward", "in"), 1),
    **dict.fromkeys(("external", "outward", "out"), -1),
}
_PLANE_WORDS = (
    frozenset({"tilt", "sagittal"}),
    frozenset({"obliquity", "list", "frontal", "coronal"}),
    frozenset({"rotation", "rot", "progression", "progress", "transverse"}),
)
_MUSCLES = re.compile(r"(?:flex|extens|duct)or")
_QUANTITIES = {
    **dict.fromkeys(("moment", "moments", "torque", "torques"), TORQUE),
    **dict.fromkeys(("power", "powers"), POWER),
    **dict.fromkeys(("grf", "reaction", "reactions", "force", "forces"), REACTION),
}
_REACTIONS = {
    **dict.fromkeys(("vertical", "upward", "up"), ("upward", 1)),
    **dict.fromkeys(("anterior", "ant", "forward", "ap"), ("forward", 1)),
    **dict.fromkeys(("posterior", "post", "backward"), ("forward", -1)),
    **dict.fromkeys(("medial", "ml"), ("medial", 1)),
    "lateral": ("medial", -1),
}

COORDINATES = frozenset(name for names in PLANES.values() for name in names if name)


def curve_of(label: str, component: str = "", quantity: str = "") -> NamedCurve | None:
    """The meaning of a name; None of one that mbkf has no curve for.

    Args:
        label: The name.
        component: "X", "Y" or "Z", where the name has three curves.
        quantity: The quantity, where it is known from elsewhere.
    """
    if not component:
        label, component = GCD_VARIABLES.get(label, (label, ""))
    output = _OUTPUT.fullmatch(label)
    if output is not None and (component or output[2] == "Power"):
        return _plug_in_gait(_OUTPUTS[output[1]], output[2], component)
    words = [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", label)]
    stated = next((_QUANTITIES[word] for word in words if word in _QUANTITIES), "")
    asked = quantity or stated or ANGLE
    if asked == REACTION:
        return _reaction(label, words)
    joint = next((_JOINTS[word] for word in words if word in _JOINTS), "")
    if asked == POWER:
        known = joint in ("Hip", "Knee", "Ankle")
        return NamedCurve(POWER, joint.lower()) if known else None
    if label in COORDINATES:
        return NamedCurve(asked, label)
    progresses = {"progression", "progress"} & set(words) or not {"rotation", "rot"} & set(words)
    if joint == "FootProgress" and (
        asked == TORQUE or not progresses
    ):  # a foot's rotation is the ankle's, too
        return None
    return _by_words(asked, joint, words) if joint else None


def _plug_in_gait(joint: str, output: str, component: str) -> NamedCurve | None:
    """An output: angles are positive in flexion, moments, which are internal, in extension."""
    if output == "Power":
        return NamedCurve(POWER, joint.lower()) if component in ("", "Z") else None
    name = PLANES[joint]["XYZ".index(component)] if component in ("X", "Y", "Z") else ""
    if not name:
        return None
    if output == "Angle":
        return NamedCurve(ANGLE, name, 1)
    in_sagittal = joint != "Ankle" or component == "X"
    return (
        NamedCurve(TORQUE, name, -1, INTERNAL) if joint in ("Hip", "Knee", "Ankle") and in_sagittal else None
    )


def _reaction(label: str, words: list[str]) -> NamedCurve | None:
    """A component of the reaction on a foot, by the first word that names one."""
    if label in ("forward", "medial", "upward"):
        return NamedCurve(REACTION, label)
    found = next((_REACTIONS[word] for word in words if word in _REACTIONS), None)
    return None if found is None else NamedCurve(REACTION, *found)


def _by_words(quantity: str, joint: str, words: list[str]) -> NamedCurve | None:
    """A curve by its plane and the direction that its words state."""
    if {"plantar", "dorsi"} & set(words):  # "plantar flexor" is one direction
        words = [word for word in words if word not in ("flexion", "flex", "flexor")]
    turns = any(word in _PLANE_WORDS[2] for word in words) or {"int", "internal"} & set(words)
    bent = [_SAGITTAL[word] for word in words if word in _SAGITTAL]
    if "ext" in words and not ("int" in words or turns):  # external beside int or rotation, else extension
        bent = [{**_SAGITTAL, "ext": -1}[word] for word in words if word in _SAGITTAL or word == "ext"]
    aside = [_FRONTAL[word] for word in words if word in _FRONTAL]
    turned = [{**_TRANSVERSE, "ext": -1}[word] for word in words if word in _TRANSVERSE or word == "ext"]
    frame = ""
    if quantity == TORQUE and (bent or aside):
        frame = next((word for word in words if word in (INTERNAL, EXTERNAL)), "")
        frame = frame or (INTERNAL if any(_MUSCLES.search(word) for word in words) else "")
    named = [bool(words_of & set(words)) for words_of in _PLANE_WORDS]
    plane = _plane(named, [bool(bent), bool(aside), bool(turned)], joint, words)
    name = "" if plane is None else PLANES[joint][plane]
    if plane is None or not name:
        return None
    senses = (bent, aside, turned)[plane]
    both = quantity == TORQUE and len(set(senses)) > 1
    return NamedCurve(quantity, name, senses[0] if senses and not both else None, "" if both else frame)


def _plane(named: list[bool], directed: list[bool], joint: str, words: list[str]) -> int | None:
    """The plane: by its own words, else by the directions; the knee's or ankle's angle alone is the sagittal one."""
    if any(named):
        return named.index(True)
    if any(directed):
        return directed.index(True)
    return 0 if joint in ("Knee", "Ankle") and {"angle", "angles"} & set(words) else None
