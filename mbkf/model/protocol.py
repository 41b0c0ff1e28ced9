"""Marker protocols: names, segments and places of a laboratory's markers, read from files in ``markers/``."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array, data_folder, read_only
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.known_keys import refuse_unknown
from mbkf.io.plain_data import number_between, parse_toml, plain_text
from mbkf.io.subject import match_names
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription
from mbkf.model.sides import mirrored

KINDS = ("anatomical", "technical", "computed", "keypoint")
"""Anatomical: on a landmark, and stays near it. Technical: anywhere on the segment; its position comes from the data.
Computed: a point that software stored (a joint centre); used for scaling, never tracked. Keypoint: a point that a
neural network found in videos (a joint centre or a feature); tracked, with correlated noise."""

DEFAULT_PLACEMENT_SD_M = {"anatomical": 0.010, "technical": 0.060, "computed": 0.006, "keypoint": 0.025}
DEFAULT_NOISE_M = {"anatomical": 0.005, "technical": 0.005, "computed": 0.005, "keypoint": 0.020}
DEFAULT_CORRELATED_M = {"anatomical": 0.0, "technical": 0.0, "computed": 0.0, "keypoint": 0.010}
FARTHEST_M, LEAST_SD_MM, MOST_SD_MM = 3.0, 1e-3, 1000.0
"""Greatest distance of a marker from its segment's origin, and bounds of the spread of its place and noise."""

DEFAULT_CORRELATION_S = 0.3

KNOWN = {
    "": ("name", "title", "body", "source", "marker", "ignored"),
    "marker": (
        "name", "landmark", "segment", "position_m", "kind", "placement_sd_mm", "noise_mm", "correlated_mm",
        "correlation_s", "aliases", "mirror", "mirror_aliases", "static_only", "probability", "alternatives",
    ),
    "ignored": ("name", "reason"),
}  # fmt: skip
"""Entries of a protocol's file."""


@dataclass(frozen=True)
class ProtocolMarker:
    """One marker of a protocol.

    Attributes:
        name: Marker name in captures.
        segment: Segment that carries it.
        position_m: (3,) position in the reference body's segment frame, m.
        kind: One of :data:`KINDS`.
        placement_sd_m: Spread of its place about that position, per coordinate (1 sd), m.
        noise_m: Measurement noise with skin movement, per coordinate (1 sd), m.
        aliases: Other names for the same marker.
        static_only: True where it is usually taken off after the static trial.
        landmark: Landmark of the body that it sits on, "" where the position alone is given.
        probability: Probability of this segment; below 1 where it was inferred.
        alternatives: Other segments that it may be on, each with its probability, likeliest first.
        correlated_m: The correlated part of the noise (1 sd), m; the rest is new in every frame.
        correlation_s: Correlation time of that part, s.
    """

    name: str
    segment: str
    position_m: Array
    kind: str
    placement_sd_m: float
    noise_m: float
    aliases: tuple[str, ...] = ()
    static_only: bool = False
    landmark: str = ""
    probability: float = 1.0
    alternatives: tuple[tuple[str, float], ...] = ()
    correlated_m: float = 0.0
    correlation_s: float = 0.0


@dataclass(frozen=True)
class Protocol:
    """A named set of markers on a body.

    Attributes:
        name: Its name.
        title: Its title in messages and pages.
        body: The reference body that the markers are placed on.
        markers: The markers in file order.
        source: Source of its definition, "" where the file states none.
        ignored: Points to be left out, by name, each with the reason.
        joined: Names that its file does not know, and that joined its markers or ignored points by inference.
    """

    name: str
    title: str
    body: BodyDescription
    markers: tuple[ProtocolMarker, ...]
    source: str = ""
    ignored: Mapping[str, str] = field(default_factory=dict)
    joined: tuple[str, ...] = ()

    def match(self, names: Iterable[str]) -> dict[str, ProtocolMarker]:
        """Protocol marker of each capture name that belongs to one (by name, then alias)."""
        return match_names(names, self.markers)


def protocol_names() -> tuple[str, ...]:
    """Names of the protocols that come with the package."""
    return tuple(sorted(path.stem for path in data_folder("markers").glob("*.toml")))


def load_protocol(name: str | Path, body: BodyDescription | None = None) -> Protocol:
    """Reads a protocol by its name, from a TOML file of the same form, or an OpenSim model that is the body itself.

    Markers of such a model (``.osim``) are where it has them: those that it states as not fixed within 60 mm, the
    others within 10 mm (standard deviations). The noise of those on a segment whose joint the body has in a simpler
    form includes the distance that this leaves.

    Args:
        name: The protocol's name, or its file.
        body: The body to place the markers on; by default the one the file names. Markers of segments and landmarks
            that this body lacks are left out, so that a full-body protocol also serves a body of the legs.

    Raises:
        UnknownName: No such protocol, or it names a segment or landmark that its own body does not have.
        FileFormatError: The file is not a valid protocol.
    """
    path = Path(name)
    if path.suffix.lower() == ".toml":
        return _parse(path, body)
    if path.suffix.lower() == ".osim":
        return _of_model(path, load_body(path) if body is None else body)
    return _shipped(str(name)) if body is None else _parse(_shipped_file(str(name)), body)


def _of_model(path: Path, body: BodyDescription) -> Protocol:
    """The markers of an OpenSim model, which are landmarks of the body that it is."""
    from mbkf.io.osim import read_osim

    model = read_osim(path)
    displaced = {one.segment: one.rms_m for one in body.approximations}
    markers = []
    for one in (one for one in model.markers if one.name in body.landmarks):
        place = body.landmarks[one.name]
        kind = "technical" if one.fixed is False else "anatomical"
        spread = DEFAULT_PLACEMENT_SD_M[kind]
        noise = math.hypot(DEFAULT_NOISE_M[kind], displaced.get(place.segment, 0.0))
        markers.append(ProtocolMarker(one.name, place.segment, place.position_m, kind, spread, noise))
    if not markers:
        raise FileFormatError(
            path, f"its markers are no landmarks of the body '{body.name}'; give --body {path.name}"
        )
    name = "_".join(path.stem.lower().split())
    return Protocol(name, f"Markers of {path.name}", body, tuple(markers))


@cache
def _shipped(name: str) -> Protocol:
    return _parse(_shipped_file(name))


def _shipped_file(name: str) -> Path:
    if name not in protocol_names():
        raise UnknownName("protocol", name, protocol_names())
    return data_folder("markers") / f"{name}.toml"


def detect_protocol(names: Iterable[str], body: BodyDescription | None = None) -> Protocol:
    """The shipped protocol that knows most of the capture's marker names.

    Ties go to the protocol with fewer markers that the capture lacks: first among those on the segments that it shows,
    without those of static trials only, then among all.

    Args:
        names: Names of the capture's markers.
        body: The body to place the markers on, as for :func:`load_protocol`.

    Raises:
        UnknownName: No protocol knows six or more of the names.
    """
    present = tuple(names)
    best, best_score = None, (0, 0, 0)
    for candidate in protocol_names():
        protocol = load_protocol(candidate, body)
        known = protocol.match(present).values()
        shown = {marker.segment for marker in known}
        worn = [marker for marker in protocol.markers if marker.kind != "computed"]
        there = {marker.name for marker in known}
        lacking = sum(m.segment in shown and m.name not in there and not m.static_only for m in worn)
        score = (len(there), -lacking, -len(worn))
        if score > best_score:
            best, best_score = protocol, score
    if best is None or best_score[0] < 6:
        raise UnknownName(
            "marker set",
            ", ".join(present[:6]) or "(no markers)",
            protocol_names(),
            "no protocol knows six of the capture's markers; give --protocol",
        )
    return best


def _parse(path: Path, body: BodyDescription | None = None) -> Protocol:
    try:
        text = plain_text(path)
        table = parse_toml(text)
        refuse_unknown(table, KNOWN, path, text)
        own = _own_body(table, path)
        body = body or own
        markers: list[ProtocolMarker] = []
        for entry in table["marker"]:
            markers += _markers(entry, body, own, path)
        name, title = table["name"], table.get("title", table["name"])
        if not isinstance(name, str) or not isinstance(title, str):
            raise ValueError("name and title must be strings")
        ignored = {str(one["name"]): str(one.get("reason", "")) for one in table.get("ignored", [])}
    except OSError as error:
        raise FileFormatError(path, f"cannot be read ({error.strerror})") from error
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid protocol: {error}") from error
    names = Counter(marker.name for marker in markers)
    for marker, times in names.items():
        if times > 1:
            raise FileFormatError(path, f"marker '{marker}' is defined twice")
    return Protocol(name, title, body, tuple(markers), str(table.get("source", "")), ignored)


def _own_body(table: dict[str, Any], path: Path) -> BodyDescription:
    """The body a protocol was written for; the path of a file is relative to the protocol's folder."""
    name = str(table.get("body", "human18"))
    return load_body(path.parent / name if name.lower().endswith((".toml", ".urdf")) else name)


def _markers(
    entry: dict[str, Any], body: BodyDescription, own: BodyDescription, path: Path
) -> list[ProtocolMarker]:
    """The marker of an entry on a body, with its mirror image where the entry names one.

    Empty where only the protocol's own body has the place.
    """
    segments = {segment.name for segment in body.segments}
    key, known, lacking = (
        ("landmark", own.landmarks, entry.get("landmark") not in body.landmarks)
        if "landmark" in entry
        else ("segment", {s.name for s in own.segments}, entry["segment"] not in segments)
    )
    if lacking and body is not own and entry[key] in known:
        return []
    one = _marker(entry, body, path)
    if "mirror" not in entry:
        return [one]
    other = mirrored(one.segment)
    if other not in segments:
        raise UnknownName("segment", other, segments, f"{path}, marker {entry['name']}, its mirror")
    mirror = replace(
        one,
        name=entry["mirror"],
        segment=other,
        position_m=read_only(one.position_m * [1.0, -1.0, 1.0]),
        landmark=mirrored(one.landmark) if one.landmark else "",
        aliases=tuple(entry.get("mirror_aliases", ())),
    )
    return [one, mirror]


def _marker(entry: dict[str, Any], body: BodyDescription, path: Path) -> ProtocolMarker:
    where = f"{path}, marker {entry['name']}"
    for key, other in (("landmark", "segment"), ("landmark", "position_m")):
        if key in entry and other in entry:
            raise FileFormatError(
                path, f"marker {entry['name']}: {key} gives its place; remove {other}, or {key}"
            )
    if "mirror_aliases" in entry and "mirror" not in entry:
        raise FileFormatError(
            path, f"marker {entry['name']}: mirror is missing, which mirror_aliases belong to"
        )
    if "landmark" in entry:
        if entry["landmark"] not in body.landmarks:
            raise UnknownName("landmark", entry["landmark"], body.landmarks, where)
        landmark = body.landmark(entry["landmark"])
        segment, position = landmark.segment, landmark.position_m
    else:
        segment, position = entry["segment"], read_only(entry["position_m"])
        if position.shape != (3,) or not (np.abs(position) <= FARTHEST_M).all():
            raise ValueError(
                f"marker {entry['name']}: position_m needs three finite numbers of at most {FARTHEST_M:g} m"
            )
    if segment not in {s.name for s in body.segments}:
        raise UnknownName("segment", segment, [s.name for s in body.segments], where)
    if not isinstance(entry.get("static_only", False), bool):
        raise ValueError(f"marker {entry['name']}: static_only must be true or false")
    kind = entry.get("kind", "anatomical" if "landmark" in entry else "technical")
    if kind not in KINDS:
        raise UnknownName("marker kind", kind, KINDS, where)
    noise, correlated, correlation_s = _noise(entry, kind)
    aliases, others = entry.get("aliases", ()), entry.get("mirror_aliases", ())
    if not all(isinstance(text, str) for text in (entry["name"], entry.get("mirror", ""), *aliases, *others)):
        raise ValueError(f"marker {entry['name']}: names and aliases must be strings")
    usual_mm = 1e3 * DEFAULT_PLACEMENT_SD_M[kind]
    return ProtocolMarker(
        name=entry["name"],
        segment=segment,
        position_m=position,
        kind=kind,
        placement_sd_m=number_between(entry, "placement_sd_mm", LEAST_SD_MM, MOST_SD_MM, usual_mm) / 1e3,
        noise_m=noise,
        aliases=tuple(aliases),
        static_only=entry.get("static_only", False),
        landmark=entry.get("landmark", ""),
        probability=number_between(entry, "probability", 0.0, 1.0, 1.0),
        alternatives=tuple((str(other), float(odds)) for other, odds in entry.get("alternatives", [])),
        correlated_m=correlated,
        correlation_s=correlation_s,
    )


def _noise(entry: dict[str, Any], kind: str) -> tuple[float, float, float]:
    """Noise, m, its correlated part, m, and that part's correlation time, s."""
    noise = number_between(entry, "noise_mm", LEAST_SD_MM, MOST_SD_MM, 1e3 * DEFAULT_NOISE_M[kind]) / 1e3
    usual = min(DEFAULT_CORRELATED_M[kind], 0.5 * noise)
    correlated = entry.get("correlated_mm", 1e3 * usual) / 1e3
    correlation_s = entry.get("correlation_s", DEFAULT_CORRELATION_S if correlated else 0.0)
    if not (0.0 <= correlated <= noise and correlation_s >= 0.0):
        raise ValueError(
            f"marker {entry['name']}: correlated_mm must be between 0 and noise_mm, correlation_s 0 or more"
        )
    return noise, correlated, correlation_s
