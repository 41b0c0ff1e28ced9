"""Measured points of a C3D file, kept apart from points that software computed and stored beside them.

A file states this for angles, forces, moments, powers and scalars (POINT:ANGLES …, named by POINT:TYPE_GROUPS).
Joint centres, segment axes and the like carry no sign but their names, so the names of Vicon Plug-in Gait and
of the Oxford Foot Model are known here. In doubt a point counts as measured.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

GROUP_KINDS = {
    "ANGLES": "angle",
    "FORCES": "force",
    "MOMENTS": "moment",
    "POWERS": "power",
    "SCALARS": "scalar",
}
"""Parameters of the group POINT that list derived points, and the kind they list."""

UNIT_PARAMETERS = {
    "angle": "ANGLE_UNITS",
    "force": "FORCE_UNITS",
    "moment": "MOMENT_UNITS",
    "power": "POWER_UNITS",
    "scalar": "SCALAR_UNITS",
    "point": "UNITS",
}
"""Parameter of the group POINT that states the unit of each kind."""

COMPUTED_PLACES = "MODELED_MARKERS"
"""Parameter of the group POINT that lists joint centres and other computed places, as Vicon's pipelines write it."""

TYPE_WORDS = {**{name: kind.upper() for name, kind in GROUP_KINDS.items()}, COMPUTED_PLACES: "MODELED_MARKER"}
"""Word of POINT:TYPE_GROUPS for the kind of each list."""

_SIDE = r"[LR]"

NAMED_KINDS = (
    ("angle", re.compile(rf"{_SIDE}?[A-Z]\w*[a-z]Angles?")),
    ("moment", re.compile(rf"{_SIDE}?[A-Z]\w*[a-z]Moment")),
    ("force", re.compile(rf"{_SIDE}?([A-Z]\w*[a-z]Force|NormalisedGRF)")),
    ("power", re.compile(rf"{_SIDE}?[A-Z]\w*[a-z]Power")),
    ("scalar", re.compile(rf"{_SIDE}?(ArchHeight(Index)?|ViconLegLength)")),
    ("point", re.compile(r"(WholeBody|Body)?Cent(re|er)OfMass(Floor)?")),
    ("point", re.compile(rf"{_SIDE}_?[HKASEW]JC")),
)
"""Names of model outputs, which are not names of markers in any file."""

FOOT_MODEL = re.compile(
    rf"({_SIDE}(FOF[0-3]|HDF[0-3]|HLX[0-3]|TIB[1-3]|HE1|D1M0|D5M0|ANK1|HFplantar|KAX|PROXFF|DISTFF)"
    rf"|proj{_SIDE}(KAX|TIB))"
)
"""Virtual points of the Oxford Foot Model; some could be markers elsewhere, so the next must be there too."""

FOOT_MODEL_SIGNATURE = re.compile(rf"{_SIDE}(HDF[0-3]|FETBA|HFTBA|FFHFA)")

AXIS_ENDS = "OALP"
"""Last letters of the four points that draw a segment's frame: origin, anterior, lateral, proximal."""


def group_kinds(parameters: Mapping[str, object]) -> dict[str, str]:
    """Name → kind of the lists of derived points: the standard ones and those of the group's TYPE_GROUPS."""
    kinds = dict(GROUP_KINDS)
    pairs = parameters.get("TYPE_GROUPS", ())
    words = [str(word).strip() for word in pairs] if isinstance(pairs, Sequence) else []
    for group, kind in zip(words[::2], words[1::2], strict=False):
        name = kind.lower()
        kinds[group.upper()] = name if name in UNIT_PARAMETERS else "point"
    return kinds


def classify(labels: Sequence[str], listed: Mapping[str, str]) -> dict[str, str]:
    """Label → kind ("angle", "force", "moment", "power", "scalar", "point") of the derived points among the labels.

    ``listed`` are the points that the file itself declares derived.
    """
    kinds = {label: listed[label] for label in labels if label in listed}
    axes = segment_axes(labels)
    foot_model = any(FOOT_MODEL_SIGNATURE.fullmatch(label) for label in labels)
    for label in labels:
        if label in kinds:
            continue
        named = next((kind for kind, pattern in NAMED_KINDS if pattern.fullmatch(label)), None)
        if named is not None:
            kinds[label] = named
        elif label in axes or (foot_model and FOOT_MODEL.fullmatch(label)):
            kinds[label] = "point"
    return kinds


def segment_axes(labels: Iterable[str]) -> set[str]:
    """Labels that come as a full set of origin, anterior, lateral and proximal point, like PELO, PELA, PELL, PELP."""
    known = set(labels)
    stems = {label[:-1] for label in known if len(label) >= 4 and label[-1] == "O"}
    complete = [stem for stem in stems if all(stem + end in known for end in AXIS_ENDS)]
    return {stem + end for stem in complete for end in AXIS_ENDS}
