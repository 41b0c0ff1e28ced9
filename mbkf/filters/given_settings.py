"""Settings of a filter as people give them, by name: numbers, words, true or false, lists of numbers.

The field of a setting states its values in ``metadata``, beyond the positive numbers that a number may have:

    words       the words that it may be
    zero        True where 0 is a value
    infinite    True where infinity is a value
    absent      word for None, where the setting may be left out
    only_with   (name, word) of another setting without which it has no effect
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import Field
from typing import TypeVar, cast

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.settings import changed, flat, leaf_fields
from mbkf.io.preset import Value, value_of

SettingsT = TypeVar("SettingsT")


def with_given(settings: SettingsT, values: Mapping[str, Value], where: str = "") -> SettingsT:
    """A filter's settings with some of them given.

    Args:
        settings: Settings of a filter.
        values: Values by the names of settings.
        where: File or option that gives them, for error messages.

    Raises:
        UnknownName: The setting does not exist, or its word is not known.
        InvalidInput: A value has the wrong type, is not possible, or contradicts another one.
    """
    known, start = leaf_fields(settings), flat(settings)
    front = f"{where}: " if where else ""
    read: dict[str, object] = {}
    for name, value in values.items():
        if name not in known:
            raise UnknownName("setting", name, known, where)
        read[name] = _read(name, known[name], start[name], value, where)
    try:
        found = changed(settings, **read)
    except InvalidInput as error:
        raise InvalidInput(f"{front}{error}") from error
    result = flat(found)
    for name in read:
        needed, word = known[name].metadata.get("only_with", ("", ""))
        if needed and result[needed] != word:
            raise InvalidInput(
                f'{front}{name} has an effect only with {needed} = "{word}", and {needed} is "{result[needed]}"; '
                f'leave {name} away, or give {needed} = "{word}"'
            )
    return found


def possible(field: Field[object], default: object) -> str:
    """The values that a setting may have, in words.

    Args:
        field: The setting.
        default: Its default.
    """
    words = field.metadata.get("words")
    if words:
        return f"one of {', '.join(words)}"
    if isinstance(default, bool):
        return "true or false"
    if isinstance(default, int):
        return "a whole number of one or more"
    if isinstance(default, tuple):
        return f"{len(default)} numbers of zero or more"
    finite = "a number of zero or more" if field.metadata.get("zero") else "a positive number"
    infinite = ", or inf" if field.metadata.get("infinite") else ""
    absent = field.metadata.get("absent")
    only = field.metadata.get("only_with")
    condition = f', with {only[0]} = "{only[1]}"' if only else ""
    return f"{finite}{infinite}" + (f', or "{absent}"' if absent else "") + condition


def plain(field: Field[object], value: object) -> Value:
    """A setting's value as files hold it: the word of an absent one in place of None."""
    return cast("Value", field.metadata.get("absent") if value is None else value)


def own_values(settings: object) -> dict[str, Value]:
    """The settings that are not the filter's defaults, by name, as files hold them."""
    usual, known = flat(type(settings)()), leaf_fields(settings)
    return {name: plain(known[name], value) for name, value in flat(settings).items() if value != usual[name]}


def _read(name: str, field: Field[object], start: object, value: Value, where: str) -> object:
    """The value of a setting.

    Args:
        name: Of the setting.
        field: The setting.
        start: Its value so far, which shows the type.
        value: As given.
        where: File or option that gives it.
    """
    words, absent = field.metadata.get("words"), field.metadata.get("absent")
    read: object = None
    if words is not None:
        if isinstance(value, str) and value not in words:
            raise UnknownName(name, value, words, where)
        read = value if isinstance(value, str) else None
    elif absent is not None and value == absent:
        return None
    elif isinstance(start, bool):
        read = value if isinstance(value, bool) else None
    elif isinstance(start, tuple):
        read = _numbers(value, len(start))
    else:
        read = _number(value, field, whole=isinstance(start, int))
    if read is None:
        front = f"{where}: " if where else ""
        raise InvalidInput(
            f"{front}{name} must be {possible(field, start)}, got {_shown(value)}{_mend(name, value)}"
        )
    return read


def _mend(name: str, value: Value) -> str:
    """Advice where a number or a truth stands in quotation marks; empty for other values."""
    meant = value_of(value) if isinstance(value, str) else None
    return "" if meant is None or isinstance(meant, str) else f"; write {name} = {_shown(meant)}"


def _number(value: Value, field: Field[object], whole: bool) -> float | None:
    """A number that the setting may be; None for anything else.

    Args:
        value: As given.
        field: The setting.
        whole: It has to be a whole number.
    """
    if isinstance(value, bool | str | tuple) or math.isnan(value) or value < 0.0:
        return None
    if whole:
        return int(value) if math.isfinite(value) and value == int(value) >= 1 else None
    zero, infinite = field.metadata.get("zero", False), field.metadata.get("infinite", False)
    return float(value) if (value > 0.0 or zero) and (math.isfinite(value) or infinite) else None


def _numbers(value: Value, count: int) -> tuple[float, ...] | None:
    """So many finite numbers of zero or more; None for anything else."""
    if not isinstance(value, tuple) or len(value) != count:
        return None
    return value if all(math.isfinite(one) and one >= 0.0 for one in value) else None


def _shown(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(f'{one:g}' for one in value)}]"
    return f'"{value}"' if isinstance(value, str) else f"{value:g}"
