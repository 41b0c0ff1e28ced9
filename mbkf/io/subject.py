"""The subject file: the result of scaling, input of every later step (TOML, written by ``mbkf scale``)."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput
from mbkf.io.body_covariance import BodyCovariance, read_covariance
from mbkf.io.inertia import SegmentInertia, parse_inertia
from mbkf.io.plain_data import number_between, parse_json, read_toml
from mbkf.io.plausible import MASSES_KG
from mbkf.io.toml import one_line_errors, write_toml

FARTHEST_M, SCALES, HEIGHTS_M = 3.0, (0.05, 20.0), (0.3, 2.8)
"""Bounds of marker places in their segments, of factors to the reference body and of heights."""

STANDING_KEY = "standing_q"
"""Key of a subject's report for the posture of the static trial: its configuration, nq numbers."""


@dataclass(frozen=True)
class SubjectMarker:
    """A marker on this subject.

    Attributes:
        name: Marker name.
        segment: Segment that carries it.
        position_m: (3,) position in the segment's frame, m.
        noise_m: Measurement noise with skin movement, per coordinate, m.
        session_sd_m: Standard deviation of its place in another trial, per coordinate, m.
        aliases: Other names for it in captures.
        correlated_m: Correlated part of the noise, per coordinate, m; 0 for a marker on skin, whose slow movement the
            filters model by themselves.
        correlation_s: Time constant of that part, s.
    """

    name: str
    segment: str
    position_m: Array
    noise_m: float
    session_sd_m: float
    aliases: tuple[str, ...] = ()
    correlated_m: float = 0.0
    correlation_s: float = 0.0


@dataclass(frozen=True)
class Subject:
    """A scaled person.

    Attributes:
        body: Name of the reference body, e.g. ``"human18"``.
        body_text: The body file of a user's own reference body, word for word; "" for the bodies that come with mbkf.
        mass_kg: Body mass.
        scale_factors: Independent scale factor by name.
        markers: The markers that follow this subject, with corrected positions.
        protocol: Name of the marker protocol.
        height_m: Body height where it was given.
        report: Plain data about the scaling (see ``mbkf.scaling``).
        inertia: By segment, the difference of its mass and centre of mass from the table.
        covariance: Uncertainty of scale factors and marker places; None for a body that counts as known exactly, or
            that an older version scaled.
    """

    body: str
    mass_kg: float
    scale_factors: dict[str, float]
    markers: tuple[SubjectMarker, ...]
    protocol: str
    height_m: float | None = None
    report: dict[str, object] = field(default_factory=dict)
    body_text: str = ""
    inertia: dict[str, SegmentInertia] = field(default_factory=dict)
    covariance: BodyCovariance | None = field(default=None, repr=False)

    @property
    def scaled_markers(self) -> Collection[str] | None:
        """Names of the markers that scaling saw; None where the report does not list them."""
        found = self.report.get("markers")
        return found if isinstance(found, Collection) else None

    @property
    def standing_q(self) -> Array | None:
        """(nq,) configuration in the static trial; None for a person scaled without one, or by an older version."""
        found = self.report.get(STANDING_KEY)
        return None if found is None else read_only(found)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.mass_kg) and self.mass_kg > 0):
            raise InvalidInput(f"mass must be positive, got {self.mass_kg} kg; give --mass KG")


class Named(Protocol):
    """Anything with a ``name`` and ``aliases``: a marker of a protocol or of a subject."""

    @property
    def name(self) -> str:
        """Its own name."""

    @property
    def aliases(self) -> tuple[str, ...]:
        """Other names for it."""


Marker = TypeVar("Marker", bound=Named)


def match_names(names: Iterable[str], markers: Iterable[Marker]) -> dict[str, Marker]:
    """The marker of each name of a capture that has one, in the order of the names: by its own name, else by an alias.

    Each marker is found once.
    """
    present, known = tuple(names), tuple(markers)
    own = {marker.name: marker for marker in known}
    taken = {name for name in present if name in own}
    by_alias = {alias: marker for marker in known if marker.name not in taken for alias in marker.aliases}
    found: dict[str, Marker] = {}
    for name in present:
        marker = own.get(name)
        if marker is None and name in by_alias and by_alias[name].name not in taken:
            marker = by_alias[name]
            taken.add(marker.name)
        if marker is not None:
            found[name] = marker
    return found


def write_subject(subject: Subject, path: str | Path) -> None:
    """Writes a subject as TOML, whole or not at all."""
    table = {
        "body": subject.body,
        "body_text": subject.body_text or None,  # the user's own reference body, word for word
        "report": json.dumps(subject.report) if subject.report else None,
        "mass_kg": float(subject.mass_kg),
        "height_m": None if subject.height_m is None else float(subject.height_m),
        "protocol": subject.protocol,
        "scale_factors": {name: float(value) for name, value in subject.scale_factors.items()},
        "inertia": {name: asdict(own) for name, own in subject.inertia.items()} or None,
        "marker": [_marker_table(marker) for marker in subject.markers],
        "covariance": None if subject.covariance is None else subject.covariance.as_table(),
    }
    comment = "A scaled subject, written by mbkf. Lengths in m, mass in kg; positions in the segment's frame."
    write_toml(path, comment, table)


def _marker_table(marker: SubjectMarker) -> dict[str, object]:
    table = asdict(marker)
    if not marker.correlated_m:
        del table["correlated_m"], table["correlation_s"]
    return table


def read_subject(path: str | Path) -> Subject:
    """Reads a subject file.

    Raises:
        FileFormatError: The file is missing, not TOML, or lacks an entry.
        InvalidInput: The mass is not positive.
    """
    source = Path(path)
    with one_line_errors(source, "a subject file", "make it with 'mbkf scale'"):
        table = read_toml(source)
        return Subject(
            body=table["body"],
            mass_kg=_mass_kg(table["mass_kg"]),
            scale_factors={
                name: number_between(table["scale_factors"], name, *SCALES) for name in table["scale_factors"]
            },
            markers=tuple(_marker(entry) for entry in table.get("marker", ())),
            protocol=table["protocol"],
            height_m=number_between(table, "height_m", *HEIGHTS_M) if "height_m" in table else None,
            report=dict(parse_json(table.get("report", "{}"))),
            body_text=str(table.get("body_text", "")),
            inertia=parse_inertia(table.get("inertia", {})),
            covariance=read_covariance(table["covariance"]) if "covariance" in table else None,
        )


def _mass_kg(stated: Any) -> float:
    """A possible body mass; one that is not positive is refused by :class:`Subject`."""
    value = float(stated)
    if isinstance(stated, bool):
        raise ValueError("mass_kg is not a number")
    if value > 0.0 and not MASSES_KG[0] <= value <= MASSES_KG[1]:
        raise InvalidInput(f"mass_kg must be between {MASSES_KG[0]:g} and {MASSES_KG[1]:g}, got {value:g}")
    return value


def _marker(entry: dict[str, Any]) -> SubjectMarker:
    position = read_only(entry["position_m"])
    if position.shape != (3,) or not (np.abs(position) <= FARTHEST_M).all():
        raise ValueError(f"marker {entry['name']} needs three finite coordinates of at most {FARTHEST_M:g} m")
    return SubjectMarker(
        entry["name"],
        entry["segment"],
        position,
        number_between(entry, "noise_m", 0.0, FARTHEST_M),
        number_between(entry, "session_sd_m", 0.0, FARTHEST_M),
        tuple(entry.get("aliases", ())),
        number_between(entry, "correlated_m", 0.0, FARTHEST_M, 0.0),
        float(entry.get("correlation_s", 0.0)),
    )
