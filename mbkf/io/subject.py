"""The subject file: the result of scaling, input of every later step (TOML, written by ``mbkf scale``)."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput
from mbkf.io import fields
from mbkf.io.body_covariance import COVARIANCE, BodyCovariance, read_covariance
from mbkf.io.inertia import INERTIA, SegmentInertia, parse_inertia
from mbkf.io.plain_data import parse_json
from mbkf.io.plausible import MASSES_KG
from mbkf.io.toml import Entries, one_line_errors, write_toml

FARTHEST_M, SPREADS_M, SCALES, HEIGHTS_M = 1.5, (1e-6, 1.0), (0.2, 2.0), (0.3, 2.8)
"""Bounds of persons: of marker places in segments, of spreads, of factors to the reference body and of heights."""

FARTHEST_TURN = 1e3
"""Bound of a coordinate of the posture, rad or m."""

FARTHEST_CENTRE_M, FARTHEST_ZERO_DEG = 0.2, 90.0
"""Bounds of a displacement of a joint centre, and of the zero of an angle or a joint's usual rotation."""

MOST_SLID = 10.0
"""Bound of a share of a displacement by flexion; at 180° it is 2."""

STANDING_KEY = "standing_q"
"""Key of a subject's report for the posture of the static trial: its configuration, nq numbers."""


_NAME = fields.text("name", "name of the marker", required=True)
_SEGMENT = fields.text("segment", "segment that carries it", required=True)
_POSITION = fields.numbers("position_m", "place in the segment's frame", 3, FARTHEST_M, "m", required=True)
_NOISE = fields.number("noise_m", "noise with skin movement", SPREADS_M, "m", required=True)
_SESSION_SD = fields.number(
    "session_sd_m", "spread of its place in another trial", SPREADS_M, "m", required=True
)
_ALIASES = fields.texts("aliases", "other names in captures")
_CORRELATED = fields.number("correlated_m", "correlated part of the noise", (0.0, SPREADS_M[1]), "m")
_CORRELATION = fields.number("correlation_s", "time constant of that part", (0.0, 1e3), "s")
_SLIDES = fields.rows(
    "slides_m", "displacement by each flexion of the body file's skin, at 60°", 3, SPREADS_M[1], "m"
)
_SLID = fields.numbers("slid", "shares of these displacements in position_m; 0 by default", None, MOST_SLID)
MARKER = fields.record(
    "marker",
    _NAME,
    _SEGMENT,
    _POSITION,
    _NOISE,
    _SESSION_SD,
    _ALIASES,
    _CORRELATED,
    _CORRELATION,
    _SLIDES,
    _SLID,
)
"""Entries of a marker in a subject file."""

_BODY = fields.text("body", "name of the reference body", required=True)
_BODY_TEXT = fields.text("body_text", "file of a reference body of your own, word for word", empty=True)
_REPORT = fields.text("report", "the scaling in JSON", empty=True)
_MASS = fields.number("mass_kg", "body mass", MASSES_KG, "kg", required=True)
_HEIGHT = fields.number("height_m", "body height", HEIGHTS_M, "m")
_PROTOCOL = fields.text("protocol", "name of the marker protocol", required=True, empty=True)
_SCALE_FACTORS = fields.part(
    "scale_factors",
    "size over that of the reference body, by factor: all of the body",
    "[scale_factors]",
    required=True,
)
_FACTOR = fields.number("factor", "a scale factor", SCALES)
_INERTIA = fields.part("inertia", "a segment's own inertia", "[inertia.SEGMENT]")
_MARKERS = fields.part("marker", "a marker", "[[marker]]")
_CENTRES = fields.part(
    "joint_centres_m",
    "displacements of joint centres, of shoulders or synthetic persons",
    "[joint_centres_m]",
)
_CENTRE = fields.number("centre", "displacement along one axis", (-FARTHEST_CENTRE_M, FARTHEST_CENTRE_M), "m")
_ZEROS = fields.part(
    "angle_zeros_deg", "zeros of angles by the bones, known of synthetic persons alone", "[angle_zeros_deg]"
)
_ZERO = fields.number("zero", "zero of an angle", (-FARTHEST_ZERO_DEG, FARTHEST_ZERO_DEG), "deg")
_HABITS = fields.part(
    "habit_deg", "how joints are held in all motions, known of synthetic persons alone", "[habit_deg]"
)
_HABIT = fields.number("habit", "rotation about one axis", (-FARTHEST_ZERO_DEG, FARTHEST_ZERO_DEG), "deg")
_COVARIANCE = fields.part("covariance", "uncertainty of factors and marker places", "[covariance]")
SUBJECT = fields.record(
    "subject",
    _BODY,
    _BODY_TEXT,
    _REPORT,
    _MASS,
    _HEIGHT,
    _PROTOCOL,
    _SCALE_FACTORS,
    _INERTIA,
    _MARKERS,
    _CENTRES,
    _ZEROS,
    _HABITS,
    _COVARIANCE,
)
"""Entries of a subject file."""


NO_SLIDES, NO_SHARES = read_only(np.zeros((0, 3))), read_only(np.zeros(0))
"""Displacements by flexion, and shares of them, of a marker of which scaling learnt nothing of the skin."""


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
        slides_m: (D, 3) displacement by each flexion (:mod:`mbkf.sensors.flexed_skin`), at 60°; no rows where scaling
            learnt nothing of the skin.
        slid: (D,) shares of them that ``position_m`` holds: 0 after scaling, where it is the place in the neutral
            posture; those of a trial's usual posture where it was corrected on that trial.
    """

    name: str
    segment: str
    position_m: Array
    noise_m: float
    session_sd_m: float
    aliases: tuple[str, ...] = ()
    correlated_m: float = 0.0
    correlation_s: float = 0.0
    slides_m: Array = field(default_factory=lambda: NO_SLIDES)
    slid: Array = field(default_factory=lambda: NO_SHARES)

    @property
    def neutral_m(self) -> Array:
        """(3,) position in the neutral posture, m."""
        return self.position_m - self.slid @ self.slides_m if self.slid.size else self.position_m

    @property
    def free_slides_m(self) -> Array:
        """(D, 3) displacements that ``position_m`` does not hold; no rows for a marker corrected on a trial."""
        return NO_SLIDES if self.slid.any() else self.slides_m


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
        joint_centres_m: Displacement of joint centres from where the scale factors put them, m, by the names of
            :func:`mbkf.model.joint_centres.centre_names`; those without a name stay there. Those of the shoulders are
            found by correction on a trial. Others are known of synthetic persons alone: scaling finds only their effect
            on what it finds.
        angle_zeros_deg: By angle, the degrees to add to its value in the body's axes for its value by this person's
            bones. Known of synthetic persons alone.
        habit_deg: By joint and axis (``"torso_y"``), the rotation in which the person holds a joint besides what a
            motion asks of everybody. Known of synthetic persons alone.
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
    joint_centres_m: dict[str, float] = field(default_factory=dict)
    angle_zeros_deg: dict[str, float] = field(default_factory=dict)
    habit_deg: dict[str, float] = field(default_factory=dict)

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

    def in_neutral_posture(self) -> Subject:
        """The person with all markers at their places in the neutral posture, as scaling leaves them."""
        if not any(marker.slid.any() for marker in self.markers):
            return self
        markers = [
            replace(
                marker, position_m=read_only(marker.neutral_m), slid=read_only(np.zeros_like(marker.slid))
            )
            for marker in self.markers
        ]
        return replace(self, markers=tuple(markers))

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
        "joint_centres_m": subject.joint_centres_m or None,
        "angle_zeros_deg": subject.angle_zeros_deg or None,
        "habit_deg": subject.habit_deg or None,
        "marker": [_marker_table(marker) for marker in subject.markers],
        "covariance": None if subject.covariance is None else subject.covariance.as_table(),
    }
    comment = "A scaled subject, written by mbkf. Lengths in m, mass in kg; positions in the segment's frame."
    write_toml(path, comment, table)


def _marker_table(marker: SubjectMarker) -> dict[str, object]:
    table = asdict(marker)
    if not marker.correlated_m:
        del table["correlated_m"], table["correlation_s"]
    if not marker.slides_m.any():
        del table["slides_m"], table["slid"]
    elif not marker.slid.any():
        del table["slid"]
    return table


def read_subject(path: str | Path) -> Subject:
    """Reads a subject file.

    Raises:
        UnknownEntry: The file has an entry that subjects do not have.
        FileFormatError: The file is missing, not TOML, or lacks or misuses an entry.
        InvalidInput: A person cannot have the segments' inertia.
    """
    hint = "make it with 'mbkf scale'"
    read = Entries.of_file(SUBJECT, path, "a subject file", hint)
    with one_line_errors(read.file, "a subject file", hint):
        if not read.need(_SCALE_FACTORS):
            raise read.fault("scale_factors is empty; it lists all of the body", _SCALE_FACTORS.key)
        subject = Subject(
            body=read.need(_BODY),
            mass_kg=read.need(_MASS),
            scale_factors=read.by_name(_SCALE_FACTORS, _FACTOR),
            markers=_markers(read),
            protocol=read.need(_PROTOCOL),
            height_m=read.get(_HEIGHT),
            report=dict(parse_json(read.get(_REPORT) or "{}")),
            body_text=read.get(_BODY_TEXT) or "",
            inertia=_inertia(read),
            covariance=_covariance(read),
            joint_centres_m=read.by_name(_CENTRES, _CENTRE),
            angle_zeros_deg=read.by_name(_ZEROS, _ZERO),
            habit_deg=read.by_name(_HABITS, _HABIT),
        )
    _check_report(subject, read)
    return subject


def _markers(read: Entries) -> tuple[SubjectMarker, ...]:
    found: dict[str, SubjectMarker] = {}
    for one in read.list_of_tables(_MARKERS, MARKER) or ():
        name = one.need(_NAME)
        one.where = f"marker {name}: "
        if name in found:
            raise one.fault("it stands twice; keep one of both")
        noise_m = one.need(_NOISE)
        correlated_m = one.get(_CORRELATED) or 0.0
        if correlated_m > noise_m:
            raise one.fault(f"correlated_m {correlated_m:g} exceeds noise_m {noise_m:g}", _CORRELATED.key)
        found[name] = SubjectMarker(
            name,
            one.need(_SEGMENT),
            read_only(one.need(_POSITION)),
            noise_m,
            one.need(_SESSION_SD),
            one.get(_ALIASES) or (),
            correlated_m,
            one.get(_CORRELATION) or 0.0,
            *_skin(one),
        )
    return tuple(found.values())


def _skin(one: Entries) -> tuple[Array, Array]:
    """(D, 3) displacements of a marker by flexion and (D,) shares of them in its place."""
    slides, slid = one.get(_SLIDES), one.get(_SLID)
    if slides is None or not len(slides):
        return NO_SLIDES, NO_SHARES
    shares = np.zeros(len(slides)) if slid is None else slid
    if len(shares) != len(slides):
        raise one.fault(f"slid has {len(shares)} numbers and slides_m {len(slides)} rows", _SLID.key)
    return read_only(slides), read_only(shares)


def _inertia(read: Entries) -> dict[str, SegmentInertia]:
    return {name: parse_inertia(one) for name, one in read.tables(_INERTIA, INERTIA).items()}


def _covariance(read: Entries) -> BodyCovariance | None:
    """The covariance, of which every factor must be a scale factor of this file.

    Raises:
        UnknownEntry: A scale factor that it names has no line.
    """
    found = read.table_of(_COVARIANCE, COVARIANCE)
    if found is None:
        return None
    covariance = read_covariance(found)
    factors = read.by_name(_SCALE_FACTORS, _FACTOR)
    lacking = [name for name in covariance.factors if name not in factors]
    if lacking:
        reason = f"scale_factors: {lacking[0]} is missing, which [covariance] names; restore its line"
        raise read.fault(reason, _SCALE_FACTORS.key)
    return covariance


def _check_report(subject: Subject, read: Entries) -> None:
    """Refuses a posture of the static trial that is not a list of finite numbers."""
    posture = subject.report.get(STANDING_KEY)
    if posture is None:
        return
    numbers = posture if isinstance(posture, list) else [None]
    if not all(isinstance(x, int | float) and abs(x) <= FARTHEST_TURN for x in numbers):
        raise read.fault(f"report: {STANDING_KEY} must be a list of finite numbers", _REPORT.key)
