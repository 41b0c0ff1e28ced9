"""Three-way merging of plain tables: a late change is laid over the changes of others, field by field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

Field = tuple[str, ...]
"""Keys from the outermost table to a value, e.g. ``("trial", "walk1", "kind")``."""


@dataclass(frozen=True)
class Difference:
    """A field that two people changed from the same value to different ones.

    Attributes:
        field: The field.
        base: Its value before both; None where it was missing.
        mine: Its value in the change that came late.
        theirs: Its value now.
    """

    field: Field
    base: object
    mine: object
    theirs: object


@dataclass(frozen=True)
class Merged:
    """Both changes in one table.

    Attributes:
        table: The table now, with every field of the late change that nobody else changed.
        differences: Fields that both changed differently; ``table`` keeps the present value of each.
    """

    table: dict[str, object]
    differences: tuple[Difference, ...]


def merged(base: Mapping[str, object], mine: Mapping[str, object], theirs: Mapping[str, object]) -> Merged:
    """Lays the change from ``base`` to ``mine`` over ``theirs``.

    A field is a value that is not a table; a list is one field. A missing field and None are the same.

    Args:
        base: The table before both changes.
        mine: The table with the late change.
        theirs: The table now.
    """
    differences: list[Difference] = []
    found = _merged(base, mine, theirs, (), differences)
    return Merged(found if isinstance(found, dict) else {}, tuple(differences))


def _merged(
    base: object, mine: object, theirs: object, field: Field, differences: list[Difference]
) -> object:
    """A value after both changes; None where it is missing, as an empty table is."""
    tables = [{} if one is None else one for one in (base, mine, theirs)]
    if all(isinstance(one, Mapping) for one in tables):
        before, after, now = (one for one in tables if isinstance(one, Mapping))
        values = {
            key: _merged(before.get(key), after.get(key), now.get(key), (*field, key), differences)
            for key in dict.fromkeys([*now, *after, *before])
        }
        return {key: value for key, value in values.items() if value is not None} or None
    old, new, present = (_plain(one) for one in (base, mine, theirs))
    if new in (old, present):
        return present
    if present != old:
        differences.append(Difference(field, old, new, present))
        return present
    return new


def _plain(value: object) -> object:
    """The value without missing fields; None for a table without any other."""
    if not isinstance(value, Mapping):
        return value
    fields = {key: _plain(one) for key, one in value.items()}
    return {key: one for key, one in fields.items() if one is not None} or None
