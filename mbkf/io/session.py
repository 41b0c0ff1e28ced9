"""session.toml: facts of a person's visit that captures do not hold, in the folder with the captures.

    name = "P01"
    mass_kg = 71.2
    height_m = 1.78
    sex = "female"
    age = 34
    protocol = "plug_in_gait"
    scaling = "session"

    [visit]
    date = 2025-03-31
    condition = "barefoot"

    [trial.walk3]
    kind = "walk"
    excluded = "stumbled"

    [[trial.walk4.event]]
    side = "right"
    kind = "strike"
    time_s = 1.25

    [[trial.walk4.video]]
    file = "walk4_front.mp4"
    begins_s = -0.35

Everything is optional; :mod:`mbkf.io.visit` has the visit. A trial is named by its file without the suffix. Events
are those that a user set, moved or kept; where a trial has any, they replace the detected ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType

from mbkf.io import fields
from mbkf.io.atomic import write_text
from mbkf.io.toml import Entries, Origin, toml_text
from mbkf.io.trial_video import VIDEO, TrialVideo, plain_videos, video_of
from mbkf.io.visit import CONDITION, VISIT, Visit, plain_visit, visit_of

SESSION_FILE = "session.toml"

MASS_KG, HEIGHT_M, AGE = (0.5, 500.0), (0.3, 2.8), (0.0, 130.0)
"""Possible values."""

SEXES = ("female", "male", "other")
SIDES = ("right", "left")

FROM_SESSION, FROM_STATIC = "session", "static"
"""Captures that a body is scaled from: the standing trial and others of the session, or the standing one alone."""


class TrialKind(StrEnum):
    """Task of a trial."""

    STATIC = "static"
    WALK = "walk"
    RUN = "run"
    SQUAT = "squat"
    JUMP = "jump"
    TURN = "turn"
    STAIRS = "stairs"
    SIT_TO_STAND = "sit_to_stand"
    UNKNOWN = "unknown"


class EventKind(StrEnum):
    """Contact event of a foot."""

    STRIKE = "strike"
    OFF = "off"


_NAME = fields.text("name", "the person's name or code; by default that of the folder", empty=True)
MASS = fields.number("mass_kg", "body mass", MASS_KG, "kg")
HEIGHT = fields.number("height_m", "body height", HEIGHT_M, "m")
_AGE = fields.number("age", "age", AGE, "years")
_SEX = fields.word("sex", "for reports", SEXES)
PROTOCOL = fields.text("protocol", "marker set: its name, or a file beside this one")
_SCALING = fields.word(
    "scaling",
    "captures for the body: standing and the trials that help, or standing alone; by default session",
    (FROM_SESSION, FROM_STATIC),
)
_TRIAL = fields.part(
    "trial", "statements on a trial, which is named by its file without suffix", "[trial.NAME]"
)
_VISIT = fields.part("visit", "facts of the visit for the head of the report", "[visit]")
SESSION = fields.record("session", _NAME, MASS, HEIGHT, _AGE, _SEX, PROTOCOL, _SCALING, _VISIT, _TRIAL)
"""Entries of a session file."""

_KIND = fields.word("kind", "its task; by default the one that its markers show", tuple(TrialKind))
_EXCLUDED = fields.text("excluded", "reason to leave it out", empty=True)
_EVENTS = fields.part(
    "event", "strikes and toe-offs by hand, instead of the detected ones", "[[trial.NAME.event]]"
)
_VIDEOS = fields.part("video", "videos beside the capture, that to show first", "[[trial.NAME.video]]")
TRIAL = fields.record("trial", _KIND, _EXCLUDED, CONDITION, _EVENTS, _VIDEOS)
"""Entries of a trial in a session file."""

_SIDE = fields.word("side", "foot", SIDES, required=True)
_EVENT_KIND = fields.word("kind", "strike or toe-off", tuple(EventKind), required=True)
_TIME = fields.number("time_s", "time of the capture", unit="s", required=True)
EVENT = fields.record("foot event", _SIDE, _EVENT_KIND, _TIME)
"""Entries of an event."""


@dataclass(frozen=True)
class FootEvent:
    """A strike or toe-off.

    Attributes:
        side: "right" or "left".
        kind: Strike or toe-off.
        time_s: Time of the capture.
    """

    side: str
    kind: EventKind
    time_s: float


@dataclass(frozen=True)
class TrialNotes:
    """Statements on one trial.

    Attributes:
        kind: Its task; None for the one detected in the capture.
        excluded: Reason to leave it out; empty for a trial that counts.
        events: Its events by hand; None for the detected ones.
        condition: Its condition; empty for that of the visit.
        videos: Its videos, that to show first.
    """

    kind: TrialKind | None = None
    excluded: str = ""
    events: tuple[FootEvent, ...] | None = None
    condition: str = ""
    videos: tuple[TrialVideo, ...] = ()


@dataclass(frozen=True)
class SessionNotes:
    """Statements on a session.

    Attributes:
        name: The person's name or code; empty for that of the folder.
        mass_kg, height_m, age: Of the person; None where not known.
        sex: One of :data:`SEXES`; empty where not known.
        protocol: Marker protocol; None for the one that the names belong to.
        trials: Statements on trials, by name.
        scaling: :data:`FROM_SESSION` or :data:`FROM_STATIC`; empty where not stated.
        visit: Facts of the visit.
    """

    name: str = ""
    mass_kg: float | None = None
    height_m: float | None = None
    age: float | None = None
    sex: str = ""
    protocol: str | None = None
    trials: Mapping[str, TrialNotes] = field(default_factory=dict)
    scaling: str = ""
    visit: Visit = field(default_factory=Visit)

    def __post_init__(self) -> None:
        object.__setattr__(self, "trials", MappingProxyType(dict(self.trials)))

    def trial(self, name: str) -> TrialNotes:
        """Statements on a trial; empty ones for a trial without an entry."""
        return self.trials.get(name, TrialNotes())

    def condition(self, trial: str) -> str:
        """Condition of a trial: its own, else that of the visit; empty where not stated."""
        return self.trial(trial).condition or self.visit.condition

    @property
    def age_at_visit(self) -> float | None:
        """The stated age, else that on the day of the visit; None where not known."""
        return self.visit.age if self.age is None else self.age


def read_session(path: str | Path) -> SessionNotes:
    """Reads a session file.

    Raises:
        UnknownEntry: It has an entry that sessions do not have.
        FileFormatError: It is missing or damaged, or an entry is not possible.
    """
    return _session(Entries.of_file(SESSION, path, "a session file", "'mbkf app' writes one"))


def session_of(table: Mapping[str, object], file: str | Path = SESSION_FILE) -> SessionNotes:
    """The session that plain data describe, the entries of a session file; ``file`` is named in messages.

    Raises:
        UnknownEntry: It has an entry that sessions do not have.
        FileFormatError: An entry is not possible.
    """
    return _session(Entries(SESSION, table, Origin(Path(file))))


def _session(read: Entries) -> SessionNotes:
    return SessionNotes(
        name=read.get(_NAME) or "",
        mass_kg=read.get(MASS),
        height_m=read.get(HEIGHT),
        age=read.get(_AGE),
        sex=read.get(_SEX) or "",
        protocol=read.get(PROTOCOL),
        trials={name: _trial(entries) for name, entries in read.tables(_TRIAL, TRIAL).items()},
        scaling=read.get(_SCALING) or "",
        visit=Visit() if (found := read.table_with_own(_VISIT, VISIT)) is None else visit_of(*found),
    )


def plain_session(notes: SessionNotes) -> dict[str, object]:
    """A session as plain data, as :func:`session_of` takes it; empty entries are left out."""
    person = {
        "name": notes.name, "sex": notes.sex, "protocol": notes.protocol, "mass_kg": notes.mass_kg,
        "height_m": notes.height_m, "age": notes.age, "scaling": notes.scaling,
    }  # fmt: skip
    trials = {name: _plain_trial(trial) for name, trial in notes.trials.items() if trial != TrialNotes()}
    found: dict[str, object] = {key: value for key, value in person.items() if value not in (None, "")}
    if visit := plain_visit(notes.visit):
        found["visit"] = visit
    if trials:
        found["trial"] = trials
    return found


def plain_events(events: Iterable[FootEvent]) -> list[dict[str, object]]:
    """Events as plain data, as a session file holds them."""
    return [{"side": event.side, "kind": event.kind.value, "time_s": event.time_s} for event in events]


def write_session(notes: SessionNotes, path: str | Path) -> None:
    """Writes a session file, whole or not at all, over a user's own; empty entries are left out.

    Raises:
        OSError: It cannot be written.
    """
    write_text(path, session_text(notes), edits=True)


def session_text(notes: SessionNotes) -> str:
    """The text of a session file; empty entries are left out."""
    return toml_text("A session, as 'mbkf app' and 'mbkf batch' read it.", plain_session(notes))


def _plain_trial(trial: TrialNotes) -> dict[str, object]:
    found: dict[str, object] = {}
    if trial.kind is not None:
        found["kind"] = trial.kind.value
    if trial.excluded:
        found["excluded"] = trial.excluded
    if trial.condition:
        found["condition"] = trial.condition
    if trial.events is not None:
        found["event"] = plain_events(trial.events)
    if trial.videos:
        found["video"] = plain_videos(trial.videos)
    return found


def _trial(read: Entries) -> TrialNotes:
    kind, events = read.get(_KIND), read.list_of_tables(_EVENTS, EVENT)
    return TrialNotes(
        None if kind is None else TrialKind(kind),
        read.get(_EXCLUDED) or "",
        None if events is None else tuple(sorted((_event(one) for one in events), key=lambda e: e.time_s)),
        read.get(CONDITION) or "",
        tuple(video_of(one) for one in read.list_of_tables(_VIDEOS, VIDEO) or ()),
    )


def _event(read: Entries) -> FootEvent:
    return FootEvent(read.need(_SIDE), EventKind(read.need(_EVENT_KIND)), read.need(_TIME))
