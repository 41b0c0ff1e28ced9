"""Marker protocols: which markers a laboratory sticks where, read from files in ``markers/``."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array, data_folder, read_only
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.subject import match_names
from mbkf.model.description import BodyDescription, load_body, mirrored

KINDS = ("anatomical", "technical", "computed")
"""Anatomical: on a landmark, stays near it. Technical: anywhere on the segment, its position comes from the data.
Computed: a point that software stored (a joint centre); used for scaling, never followed."""

DEFAULT_PLACEMENT_SD_M = {"anatomical": 0.010, "technical": 0.060, "computed": 0.006}
DEFAULT_NOISE_M = 0.005


@dataclass(frozen=True)
class ProtocolMarker:
    """One marker of a protocol.

    Attributes:
        name: Marker name in captures.
        segment: Segment that carries it.
        position_m: (3,) position in the reference body's segment frame, m.
        kind: One of :data:`KINDS`.
        placement_sd_m: How far the marker may sit from that position, per coordinate (1 sd), m.
        noise_m: Measurement noise with skin movement, per coordinate (1 sd), m.
        aliases: Other names for the same marker.
        static_only: Whether it is usually taken off after the static trial.
    """

    name: str
    segment: str
    position_m: Array
    kind: str
    placement_sd_m: float
    noise_m: float
    aliases: tuple[str, ...] = ()
    static_only: bool = False


@dataclass(frozen=True)
class Protocol:
    """A named set of markers on a body; ``markers`` in file order."""

    name: str
    title: str
    body: str
    markers: tuple[ProtocolMarker, ...]

    def match(self, names: Iterable[str]) -> dict[str, ProtocolMarker]:
        """Which of the given capture names belong to which protocol marker (by name, then alias)."""
        return match_names(names, self.markers)


def protocol_names() -> tuple[str, ...]:
    """Names of the protocols that come with the package."""
    return tuple(sorted(path.stem for path in data_folder("markers").glob("*.toml")))


def load_protocol(name: str) -> Protocol:
    """Reads a protocol by its name, or from a TOML file of the same form.

    Raises:
        UnknownName: No such protocol, or it names an unknown segment or landmark.
        FileFormatError: The file is not a valid protocol.
    """
    path = Path(name)
    if path.suffix == ".toml":
        return _parse(path)
    return _shipped(name)


@cache
def _shipped(name: str) -> Protocol:
    if name not in protocol_names():
        raise UnknownName("protocol", name, protocol_names())
    return _parse(data_folder("markers") / f"{name}.toml")


def detect_protocol(names: Iterable[str]) -> Protocol:
    """The shipped protocol that explains most of the capture's marker names.

    Ties go to the protocol with fewer markers that the capture lacks.

    Raises:
        UnknownName: No protocol knows even six of the names.
    """
    present = tuple(names)
    best, best_score = None, (0, 0)
    for candidate in protocol_names():
        protocol = load_protocol(candidate)
        known = len(protocol.match(present))
        tracked = sum(marker.kind != "computed" for marker in protocol.markers)
        if (known, -tracked) > best_score:
            best, best_score = protocol, (known, -tracked)
    if best is None or best_score[0] < 6:
        raise UnknownName(
            "marker set",
            ", ".join(present[:6]) or "(no markers)",
            protocol_names(),
            "no protocol knows these markers, give --protocol",
        )
    return best


def _parse(path: Path) -> Protocol:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        body = load_body(table.get("body", "human18"))
        markers: list[ProtocolMarker] = []
        for entry in table["marker"]:
            markers += _markers(entry, body, path)
        name = table["name"]
    except OSError as error:
        raise FileFormatError(path, f"cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid protocol ({error})") from error
    names = [marker.name for marker in markers]
    for marker in names:
        if names.count(marker) > 1:
            raise FileFormatError(path, f"marker '{marker}' stands twice")
    return Protocol(name, table.get("title", name), body.name, tuple(markers))


def _markers(entry: dict[str, Any], body: BodyDescription, path: Path) -> list[ProtocolMarker]:
    """The marker of an entry, and its mirror image where the entry names one."""
    own = _marker(entry, body, path)
    if "mirror" not in entry:
        return [own]
    other = mirrored(own.segment)
    position = own.position_m * [1.0, -1.0, 1.0]
    return [
        own,
        ProtocolMarker(
            entry["mirror"],
            other,
            read_only(position),
            own.kind,
            own.placement_sd_m,
            own.noise_m,
            tuple(entry.get("mirror_aliases", ())),
            own.static_only,
        ),
    ]


def _marker(entry: dict[str, Any], body: BodyDescription, path: Path) -> ProtocolMarker:
    known = {
        "name",
        "landmark",
        "segment",
        "position_m",
        "kind",
        "placement_sd_mm",
        "noise_mm",
        "aliases",
        "mirror",
        "mirror_aliases",
        "static_only",
    }
    for key in entry:
        if key not in known:
            raise UnknownName("key", key, sorted(known), f"{path}, marker {entry.get('name', '?')}")
    where = f"{path}, marker {entry['name']}"
    if "landmark" in entry:
        if entry["landmark"] not in body.landmarks:
            raise UnknownName("landmark", entry["landmark"], body.landmarks, where)
        landmark = body.landmark(entry["landmark"])
        segment, position = landmark.segment, landmark.position_m
    else:
        segment = entry["segment"]
        position = read_only(entry["position_m"])
        if position.shape != (3,) or not np.isfinite(position).all():
            raise FileFormatError(path, f"marker {entry['name']}: position_m needs three finite numbers")
    if segment not in {s.name for s in body.segments}:
        raise UnknownName("segment", segment, [s.name for s in body.segments], where)
    if not isinstance(entry.get("static_only", False), bool):
        raise FileFormatError(path, f"marker {entry['name']}: static_only is true or false")
    kind = entry.get("kind", "anatomical" if "landmark" in entry else "technical")
    if kind not in KINDS:
        raise UnknownName("marker kind", kind, KINDS, where)
    return ProtocolMarker(
        name=entry["name"],
        segment=segment,
        position_m=position,
        kind=kind,
        placement_sd_m=entry.get("placement_sd_mm", 1e3 * DEFAULT_PLACEMENT_SD_M[kind]) / 1e3,
        noise_m=entry.get("noise_mm", 1e3 * DEFAULT_NOISE_M) / 1e3,
        aliases=tuple(entry.get("aliases", ())),
        static_only=entry.get("static_only", False),
    )
