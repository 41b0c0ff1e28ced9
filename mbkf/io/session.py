"""session.toml: what is known of a person's visit besides the captures, in the folder that holds them.

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

Everything is optional. A trial goes by its file's name without the suffix. Events are those that a person set, moved or
kept; where a trial has any, they stand instead of the found ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from mbkf.errors import FileFormatError
from mbkf.io.atomic import replacing
from mbkf.io.plain_data import read_toml
from mbkf.io.text import toml_text

SESSION_FILE = "session.toml"

MASS_KG, HEIGHT_M, AGE = (0.5, 500.0), (0.3, 2.8), (0.0, 130.0)
"""What is possible."""

SEXES = ("female", "male", "other")
SIDES = ("right", "left")

T = TypeVar("T")


class TrialKind(StrEnum):
    """What a person does in a trial."""

    STATIC = "static"
    WALK = "walk"
    RUN = "run"
    SQUAT = "squat"
    JUMP = "jump"
    UNKNOWN = "unknown"


class EventKind(StrEnum):
    """What a foot does in an instant."""

    STRIKE = "strike"
    OFF = "off"


@dataclass(frozen=True)
class FootEvent:
    """A strike or toe-off.

    Attributes:
        side: "right" or "left".
        kind: What the foot does.
        time_s: When, in the capture's time.
    """

    side: str
    kind: EventKind
    time_s: float


@dataclass(frozen=True)
class TrialNotes:
    """What is stated of one trial.

    Attributes:
        kind: What it is; None for what its capture tells.
        excluded: Why it is left out; empty where it is not.
        events: Its events by hand; None for those that are found.
    """

    kind: TrialKind | None = None
    excluded: str = ""
    events: tuple[FootEvent, ...] | None = None


@dataclass(frozen=True)
class SessionNotes:
    """What is stated of a session.

    Attributes:
        name: The person's name or code; empty for that of the folder.
        mass_kg, height_m, age: Of the person; None where they are not known.
        sex: One of :data:`SEXES`; empty where it is not known.
        protocol: Marker protocol; None for the one that the names belong to.
        trials: What is stated of trials, by name.
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
        """What is stated of a trial; nothing for one that is not named."""
        return self.trials.get(name, TrialNotes())


def read_session(path: str | Path) -> SessionNotes:
    """Reads a session file.

    Raises:
        FileFormatError: It is missing or damaged, or an entry is not possible.
    """
    file = Path(path)
    try:
        table = read_toml(file)
    except (OSError, ValueError) as error:
        raise FileFormatError(file, f"is no session file ({error})") from error
    return session_of(table, file)


def session_of(table: Mapping[str, object], file: str | Path = SESSION_FILE) -> SessionNotes:
    """What plain data state of a session.

    Args:
        table: The entries of a session file.
        file: Where they are from, for messages.

    Raises:
        FileFormatError: An entry is not possible.
    """
    read = _Entries(Path(file), table, "")
    trials = read.tables("trial")
    return SessionNotes(
        name=read.text("name") or "",
        mass_kg=read.number("mass_kg", MASS_KG),
        height_m=read.number("height_m", HEIGHT_M),
        age=read.number("age", AGE),
        sex=read.one_of("sex", SEXES) or "",
        protocol=read.text("protocol"),
        trials={name: _trial(entries) for name, entries in trials.items()},
    )


def plain_session(notes: SessionNotes) -> dict[str, object]:
    """What is stated of a session as plain data, as :func:`session_of` takes it; what says nothing is left out."""
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
    """Writes a session file, whole or not at all; entries that say nothing are left out.

    Raises:
        OSError: It cannot be written.
    """
    lines = ["# A session, as 'mbkf app' and 'mbkf batch' read it."]
    lines += [
        f"{key} = {toml_text(value)}"
        for key, value in (("name", notes.name), ("sex", notes.sex), ("protocol", notes.protocol))
        if value
    ]
    lines += [
        f"{key} = {float(value)!r}"
        for key, value in (("mass_kg", notes.mass_kg), ("height_m", notes.height_m), ("age", notes.age))
        if value is not None
    ]
    for name, trial in notes.trials.items():
        if trial != TrialNotes():
            lines += _trial_lines(f"trial.{toml_text(name)}", trial)
    with replacing(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _plain_trial(trial: TrialNotes) -> dict[str, object]:
    found: dict[str, object] = {}
    if trial.kind is not None:
        found["kind"] = trial.kind.value
    if trial.excluded:
        found["excluded"] = trial.excluded
    if trial.events is not None:
        found["event"] = plain_events(trial.events)
    return found


def _trial(read: _Entries) -> TrialNotes:
    kind = read.one_of("kind", tuple(TrialKind))
    events = read.list_of_tables("event")
    return TrialNotes(
        None if kind is None else TrialKind(kind),
        read.text("excluded") or "",
        None if events is None else tuple(sorted((_event(one) for one in events), key=lambda e: e.time_s)),
    )


def _event(read: _Entries) -> FootEvent:
    side, kind = read.one_of("side", SIDES), read.one_of("kind", tuple(EventKind))
    time_s = read.number("time_s", (-math.inf, math.inf))
    if side is None or kind is None or time_s is None:
        raise FileFormatError(read.file, f"{read.where}an event needs side, kind and time_s")
    return FootEvent(side, EventKind(kind), time_s)


def _trial_lines(place: str, trial: TrialNotes) -> list[str]:
    lines = ["", f"[{place}]"]
    if trial.kind is not None:
        lines.append(f"kind = {toml_text(trial.kind)}")
    if trial.excluded:
        lines.append(f"excluded = {toml_text(trial.excluded)}")
    if trial.events == ():
        lines.append("event = []")
    for event in trial.events or ():
        lines += [
            "",
            f"[[{place}.event]]",
            f"side = {toml_text(event.side)}",
            f"kind = {toml_text(event.kind)}",
        ]
        lines.append(f"time_s = {float(event.time_s)!r}")
    return lines


class _Entries:
    """Entries of a table, each as it must be."""

    def __init__(self, file: Path, table: Mapping[str, object], where: str) -> None:
        self.file, self.where, self._table = file, where, table

    def text(self, key: str) -> str | None:
        """A text that is not empty; None where there is none."""
        return self._checked(key, lambda value: value if isinstance(value, str) and value else None, "a text")

    def one_of(self, key: str, known: tuple[str, ...]) -> str | None:
        """One of the known words; None where there is none."""
        return self._checked(
            key, lambda value: value if value in known else None, f"one of {', '.join(known)}"
        )

    def number(self, key: str, span: tuple[float, float]) -> float | None:
        """A finite number in a span; None where there is none."""

        def read(value: object) -> float | None:
            if isinstance(value, bool) or not isinstance(value, int | float):
                return None
            try:
                found = float(value)
            except OverflowError:
                return None
            return found if math.isfinite(found) and span[0] <= found <= span[1] else None

        told = "a number" if math.isinf(span[0]) else f"a number between {span[0]:g} and {span[1]:g}"
        return self._checked(key, read, told)

    def tables(self, key: str) -> dict[str, _Entries]:
        """Tables of a table, by name."""
        found = self._table.get(key, {})
        if not isinstance(found, dict) or not all(isinstance(one, dict) for one in found.values()):
            raise FileFormatError(self.file, f"{self.where}{key} must hold tables, [{key}.NAME]")
        return {name: _Entries(self.file, one, f"{key} {name}: ") for name, one in found.items()}

    def list_of_tables(self, key: str) -> list[_Entries] | None:
        """Tables one after another; None where there is no such entry."""
        found = self._table.get(key)
        if found is None:
            return None
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise FileFormatError(self.file, f"{self.where}{key} must be a list of tables")
        return [_Entries(self.file, one, self.where) for one in found]

    def _checked(self, key: str, read: Callable[[object], T | None], told: str) -> T | None:
        if key not in self._table:
            return None
        found = read(self._table[key])
        if found is None:
            value = str(self._table[key])
            shown = value if len(value) <= 40 else value[:40] + " …"
            raise FileFormatError(self.file, f"{self.where}{key} must be {told}, got {shown}")
        return found
