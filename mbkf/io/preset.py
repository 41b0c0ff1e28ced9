"""Preset files: settings of a filter under a name, with where they come from (TOML, written by ``mbkf tune``)."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.atomic import replacing
from mbkf.io.plain_data import read_toml

FOLDER_VARIABLE = "MBKF_PRESETS"
"""Environment variable that names the folder of named presets."""

SUFFIX = ".toml"
_HINT = "make it with 'mbkf tune'"
_KEYS = ("name", "filter", "version", "note", "tuned_on", "held_out", "values", "found", "likelihood")


@dataclass(frozen=True)
class Preset:
    """Tuned settings of a filter.

    Attributes:
        name: Its name.
        filter: Which filter they are for.
        values: Settings by name, those that differ from the defaults or were tried.
        version: Of mbkf when they were found.
        note: Remark for the user.
        tuned_on, held_out: Trials they were found on, and judged on.
        found: Result of the search, where it was no better on the held-out trials and ``values`` stayed.
        likelihood: Log-likelihoods per reading by name, in nats.
    """

    name: str
    filter: str
    values: Mapping[str, float]
    version: str = ""
    note: str = ""
    tuned_on: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    found: Mapping[str, float] = field(default_factory=dict)
    likelihood: Mapping[str, float] = field(default_factory=dict)


def preset_folder() -> Path:
    """Where named presets live: ``$MBKF_PRESETS``, else ``mbkf/presets`` in ``$XDG_CONFIG_HOME`` or ``~/.config``."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "mbkf" / "presets"


def saved_presets() -> dict[str, Path]:
    """Files of the user's presets by name."""
    return {path.stem: path for path in sorted(preset_folder().glob(f"*{SUFFIX}"))}


def write_preset(preset: Preset, path: str | Path) -> None:
    """Writes a preset as TOML, whole or not at all."""
    lines = [
        "# Settings of a filter of mbkf; use them with 'mbkf reconstruct --preset'.",
        f"name = {_text(preset.name)}",
        f"filter = {_text(preset.filter)}",
        f"version = {_text(preset.version)}",
        f"note = {_text(preset.note)}",
        f"tuned_on = [{', '.join(map(_text, preset.tuned_on))}]",
        f"held_out = [{', '.join(map(_text, preset.held_out))}]",
    ]
    tables = {"values": preset.values, "found": preset.found, "likelihood": preset.likelihood}
    for title, table in tables.items():
        if table or title == "values":
            lines += ["", f"[{title}]", *(f"{key} = {float(value)!r}" for key, value in table.items())]
    with replacing(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_preset(path: str | Path) -> Preset:
    """Reads a preset file.

    Raises:
        FileFormatError: The file is missing, not TOML, or lacks or misuses an entry.
        UnknownName: It has an entry that presets do not have.
    """
    source = Path(path)
    try:
        table = read_toml(source)
        unknown = [key for key in table if key not in _KEYS]
        if unknown:
            raise UnknownName("entry", unknown[0], _KEYS, str(source))
        return Preset(
            name=_string(table.get("name", source.stem)),
            filter=_string(table["filter"]),
            values=_numbers(table["values"]),
            version=_string(table.get("version", "")),
            note=_string(table.get("note", "")),
            tuned_on=tuple(map(_string, table.get("tuned_on", ()))),
            held_out=tuple(map(_string, table.get("held_out", ()))),
            found=_numbers(table.get("found", {})),
            likelihood=_numbers(table.get("likelihood", {})),
        )
    except FileNotFoundError as error:
        raise FileFormatError(source, f"no such file; {_HINT}") from error
    except (OSError, UnicodeError) as error:
        raise FileFormatError(source, f"cannot be read ({error})") from error
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(source, f"not a preset file ({error}); {_HINT}") from error


def _string(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is no text")
    return value


def _numbers(table: Mapping[str, Any]) -> dict[str, float]:
    for key, value in table.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError(f"{key} = {value!r} is no finite number")
    return {key: float(value) for key, value in table.items()}


def _text(value: str) -> str:
    """A TOML basic string: JSON's, with DEL escaped, too."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
