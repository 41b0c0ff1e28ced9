"""Changes in a TOML file that people edit: entries change, and comments, order and blank lines stay."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, MutableMapping

import tomlkit
from tomlkit.exceptions import TOMLKitError


def edited_toml(text: str, written: str) -> str:
    """A file's text with the entries of another one.

    Args:
        text: The file as it is.
        written: A file with the new entries, as :func:`~mbkf.io.toml.toml_text` makes it.

    Returns:
        The old text with the new entries; ``written`` where that is not possible.
    """
    wanted = tomllib.loads(written)
    try:
        document = tomlkit.parse(text)
        _lay_over(document, wanted)
        found = tomlkit.dumps(document)
        return found if tomllib.loads(found) == wanted else written
    except (TOMLKitError, ValueError):
        return written


def _lay_over(old: MutableMapping[str, object], new: Mapping[str, object]) -> None:
    """Makes the old entries equal to the new ones; equal ones are not touched."""
    for key in [key for key in old if key not in new]:
        del old[key]
    for key, value in new.items():
        before = old.get(key)
        if isinstance(before, MutableMapping) and isinstance(value, Mapping):
            _lay_over(before, value)
        elif before != value:
            old[key] = value
