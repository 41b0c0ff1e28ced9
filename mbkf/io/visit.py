"""The table ``[visit]`` of a session file: facts of the examination for the head of a report.

    [visit]
    date = 2025-03-31
    birth_date = 1988-11-02
    condition = "barefoot"
    side = "left"
    diagnosis = "Hemiparesis"
    notes = "Tired after the third walk."
    clinician = "Dr. E. Example"

Everything is optional. Entries of other names are a laboratory's own: they are kept and shown under their names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from datetime import date, datetime, time
from types import MappingProxyType

from mbkf.io import fields as declared
from mbkf.io.toml import Entries

BAREFOOT, SHOES = "barefoot", "shoes"
CONDITIONS = (BAREFOOT, SHOES, "orthosis", "prosthesis", "aid")
"""Conditions with a translation; a walking aid is "aid". Any other text is shown as it stands."""

UNAIDED = ("", BAREFOOT, SHOES)
"""Conditions of persons that norms may be built of."""

AFFECTED = ("right", "left", "both")

_DATE = declared.day("date", "day of the visit")
_BIRTH_DATE = declared.day("birth_date", "the person's day of birth")
CONDITION = declared.text(
    "condition", f"condition of walking: {', '.join(CONDITIONS)}, or a text of your own", empty=True
)
_SIDE = declared.word("side", "affected side", AFFECTED)
_DIAGNOSIS = declared.text("diagnosis", "diagnosis, or reason of the visit", empty=True)
_NOTES = declared.text("notes", "notes for the report", empty=True)
_CLINICIAN = declared.text("clinician", "person who signs the report", empty=True)
VISIT = declared.record("visit", _DATE, _BIRTH_DATE, CONDITION, _SIDE, _DIAGNOSIS, _NOTES, _CLINICIAN)
"""Entries of a visit that mbkf knows."""

Plain = str | int | float | bool


@dataclass(frozen=True)
class Visit:
    """A visit; an empty text where an entry is not stated.

    Attributes:
        date, birth_date: Days as in "2025-03-31".
        condition: One of :data:`CONDITIONS`, or a text of the laboratory.
        side: One of :data:`AFFECTED`.
        diagnosis, notes, clinician: Texts.
        others: The laboratory's own entries.
    """

    date: str = ""
    birth_date: str = ""
    condition: str = ""
    side: str = ""
    diagnosis: str = ""
    notes: str = ""
    clinician: str = ""
    others: Mapping[str, Plain] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "others", MappingProxyType(dict(self.others)))

    @property
    def age(self) -> int | None:
        """Age on the day of the visit in completed years; None where one of both days is not stated."""
        if not (self.date and self.birth_date):
            return None
        born, seen = date.fromisoformat(self.birth_date), date.fromisoformat(self.date)
        return seen.year - born.year - ((seen.month, seen.day) < (born.month, born.day))

    @property
    def fault(self) -> str:
        """The reason for which the days exclude each other; empty where they do not."""
        wrong = bool(self.date) and self.birth_date > self.date
        return f"birth_date {self.birth_date} lies after date {self.date}" if wrong else ""

    def within(self, above: Visit) -> Visit:
        """This visit with the entries of the folder above it where it states no own ones."""
        own = {one: getattr(self, one) or getattr(above, one) for one in _TEXTS}
        return Visit(**own, others={**above.others, **self.others})


_TEXTS = tuple(one.name for one in fields(Visit) if one.name != "others")


def visit_of(read: Entries, own: Mapping[str, object]) -> Visit:
    """The visit of a session file.

    Args:
        read: The entries that mbkf knows.
        own: The laboratory's own ones.

    Raises:
        FileFormatError: An entry is not possible.
    """
    found = Visit(
        read.get(_DATE) or "",
        read.get(_BIRTH_DATE) or "",
        read.get(CONDITION) or "",
        read.get(_SIDE) or "",
        read.get(_DIAGNOSIS) or "",
        read.get(_NOTES) or "",
        read.get(_CLINICIAN) or "",
        {key: _own(key, value, read) for key, value in own.items()},
    )
    if found.fault:
        raise read.fault(found.fault, "birth_date")
    return found


def plain_visit(visit: Visit) -> dict[str, Plain]:
    """A visit as plain data; empty entries are left out."""
    texts = {one: text for one in _TEXTS if (text := getattr(visit, one))}
    return {**texts, **visit.others}


def _own(key: str, value: object, read: Entries) -> Plain:
    """An entry of the laboratory's own.

    Raises:
        FileFormatError: It is no text, number, flag, day or time.
    """
    if isinstance(value, date | time | datetime):
        return value.isoformat()
    if isinstance(value, str | bool | int) or (isinstance(value, float) and math.isfinite(value)):
        return value
    raise read.fault(f"{key} must be a text, a number, or true or false", key)
