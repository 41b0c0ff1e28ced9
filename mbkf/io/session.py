"""session.toml: facts of a person's visit that captures do not hold, in the folder with the captures.

    name = "P01"
    mass_kg = 71.2
    height_m = 1.78
    sex = "female"
    age = 34
    protocol = "plug_in_gait"

    [trial.walk3]
    kind = "walk"
    excluded = "stumbled"

    [[trial.walk4.event]]
    side = "right"
    kind = "strike"
    time_s = 1.25

Everything is optional. A trial is named by its file without the suffix. Events are those that a user set, moved or
kept; where a trial has any, they replace the detected ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType

from mbkf.errors import FileFormatError
from mbkf.io.atomic import write_text
from mbkf.io.toml import Entries, toml_text

SESSION_FILE = "session.toml"

MASS_KG, HEIGHT_M, AGE = (0.5, 500.0), (0.3, 2.8), (0.0, 130.0)
"""Possible values."""

SEXES = ("female", "male", "other")
SIDES = ("right", "left")


class TrialKind(StrEnum):
    """Task of a trial."""

    STATIC = "static"
    WALK = "walk"
    RUN = "run"
    SQUAT = "squat"
    JUMP = "jump"
    UNKNOWN = "unknown"


class EventKind(StrEnum):
    """Contact event of a foot."""

    STRIKE = "strike"
    OFF = "off"


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
    """

    kind: TrialKind | None = None
    excluded: str = ""
    events: tuple[FootEvent, ...] | None = None


@dataclass(frozen=True)
class SessionNotes:
    """Statements on a session.

    Attributes:
        name: The person's name or code; empty for that of the folder.
        mass_kg, height_m, age: Of the person; None where not known.
        sex: One of :data:`SEXES`; empty where not known.
        protocol: Marker protocol; None for the one that the names belong to.
        trials: Statements on trials, by name.
    """

    name: str = ""
    mass_kg: float | None = None
    height_m: float | None = None
    age: float | None = None
    sex: str = ""
    protocol: str | None = None
    trials: Mapping[str, TrialNotes] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "trials", MappingProxyType(dict(self.trials)))

    def trial(self, name: str) -> TrialNotes:
        """Statements on a trial; empty ones for a trial without an entry."""
        return self.trials.get(name, TrialNotes())


def read_session(path: str | Path) -> SessionNotes:
    """Reads a session file.

    Raises:
        FileFormatError: It is missing or damaged, or an entry is not possible.
    """
    return _session(Entries.of_file(path, "a session file", "'mbkf app' writes one"))


def session_of(table: Mapping[str, object], file: str | Path = SESSION_FILE) -> SessionNotes:
    """The session that plain data describe, the entries of a session file; ``file`` is named in messages.

    Raises:
        FileFormatError: An entry is not possible.
    """
    return _session(Entries(Path(file), table))


def _session(read: Entries) -> SessionNotes:
    return SessionNotes(
        name=read.text("name") or "",
        mass_kg=read.number("mass_kg", MASS_KG),
        height_m=read.number("height_m", HEIGHT_M),
        age=read.number("age", AGE),
        sex=read.one_of("sex", SEXES) or "",
        protocol=read.text("protocol"),
        trials={name: _trial(entries) for name, entries in read.tables("trial").items()},
    )


def plain_session(notes: SessionNotes) -> dict[str, object]:
    """A session as plain data, as :func:`session_of` takes it; empty entries are left out."""
    person = {
        "name": notes.name, "sex": notes.sex, "protocol": notes.protocol, "mass_kg": notes.mass_kg,
        "height_m": notes.height_m, "age": notes.age,
    }  # fmt: skip
    trials = {name: _plain_trial(trial) for name, trial in notes.trials.items() if trial != TrialNotes()}
    found: dict[str, object] = {key: value for key, value in person.items() if value not in (None, "")}
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
    if trial.events is not None:
        found["event"] = plain_events(trial.events)
    return found


def _trial(read: Entries) -> TrialNotes:
    kind = read.one_of("kind", tuple(TrialKind))
    events = read.list_of_tables("event")
    return TrialNotes(
        None if kind is None else TrialKind(kind),
        read.text("excluded") or "",
        None if events is None else tuple(sorted((_event(one) for one in events), key=lambda e: e.time_s)),
    )


def _event(read: Entries) -> FootEvent:
    side, kind = read.one_of("side", SIDES), read.one_of("kind", tuple(EventKind))
    time_s = read.number("time_s")
    if side is None or kind is None or time_s is None:
        raise FileFormatError(read.file, f"{read.where}an event needs side, kind and time_s")
    return FootEvent(side, EventKind(kind), time_s)
