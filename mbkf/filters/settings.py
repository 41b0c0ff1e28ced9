"""Settings of filters: frozen records of their blocks' settings, whose leaves have names that occur once.

A preset file, ``mbkf tune`` and ``summary.json`` name a setting by its leaf alone, as ``plate_force_n``.
"""

from __future__ import annotations

from dataclasses import Field, fields, is_dataclass, replace
from typing import Any, TypeVar

from mbkf.errors import UnknownName

SettingsT = TypeVar("SettingsT")


def flat(settings: object) -> dict[str, object]:
    """Every leaf of a record of settings by its name."""
    found: dict[str, object] = {}
    for one in fields(settings):  # type: ignore[arg-type]
        value = getattr(settings, one.name)
        found |= flat(value) if is_dataclass(value) else {one.name: value}
    return found


def leaf_fields(settings: object) -> dict[str, Field[object]]:
    """The field of every leaf of a record of settings by its name."""
    found: dict[str, Field[object]] = {}
    for one in fields(settings):  # type: ignore[arg-type]
        value = getattr(settings, one.name)
        found |= leaf_fields(value) if is_dataclass(value) else {one.name: one}
    return found


def changed(settings: SettingsT, **values: object) -> SettingsT:
    """The settings with some leaves changed, wherever they stand.

    Raises:
        UnknownName: The setting does not exist.
    """
    known = flat(settings)
    for name in values:
        if name not in known:
            raise UnknownName("setting", name, known)
    return _changed(settings, values)


def _changed(settings: Any, values: dict[str, object]) -> Any:
    changes: dict[str, object] = {}
    for one in fields(settings):
        value = getattr(settings, one.name)
        if is_dataclass(value):
            changes[one.name] = _changed(value, values)
        elif one.name in values:
            changes[one.name] = values[one.name]
    return replace(settings, **changes)
