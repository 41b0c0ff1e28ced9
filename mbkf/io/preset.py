"""Preset files: settings of a filter under a name, with their origin (TOML, written by ``mbkf tune``)."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mbkf.errors import UnknownName
from mbkf.io.plain_data import read_toml
from mbkf.io.toml import one_line_errors, write_toml

FOLDER_VARIABLE = "MBKF_PRESETS"
"""Environment variable that names the folder of named presets."""

SUFFIX = ".toml"
_KEYS = ("name", "filter", "version", "note", "tuned_on", "held_out", "values", "found", "likelihood")


@dataclass(frozen=True)
class Preset:
    """Tuned settings of a filter.

    Attributes:
        name: Its name.
        filter: The filter they are for.
        values: Settings by name, those that differ from the defaults or were tried.
        version: Of mbkf when they were found.
        note: Remark for the user.
        tuned_on, held_out: Trials of the search, and of its validation.
        found: Result of the search, where it did no better on the held-out trials and ``values`` stayed.
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
    """Folder of named presets: ``$MBKF_PRESETS``, else ``mbkf/presets`` in ``$XDG_CONFIG_HOME`` or ``~/.config``."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "mbkf" / "presets"


def saved_presets() -> dict[str, Path]:
    """Files of the user's presets by name."""
    return {path.stem: path for path in sorted(preset_folder().glob(f"*{SUFFIX}"))}


def write_preset(preset: Preset, path: str | Path) -> None:
    """Writes a preset as TOML, whole or not at all."""
    table = asdict(preset)
    values = {key: table.pop(key) for key in ("values", "found", "likelihood")}
    full = {**table, **{key: value for key, value in values.items() if value or key == "values"}}
    write_toml(
        path, "Settings of a filter, written by mbkf; use them with 'mbkf reconstruct --preset'.", full
    )


def read_preset(path: str | Path) -> Preset:
    """Reads a preset file.

    Raises:
        FileFormatError: The file is missing, not TOML, or lacks or misuses an entry.
        UnknownName: It has an entry that presets do not have.
    """
    source = Path(path)
    with one_line_errors(source, "a preset file", "make it with 'mbkf tune'"):
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


def _string(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not a text")
    return value


def _numbers(table: Mapping[str, Any]) -> dict[str, float]:
    for key, value in table.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError(f"{key} = {value!r} is not a finite number")
    return {key: float(value) for key, value in table.items()}
