"""Preset files: settings of a filter under a name, with their origin (TOML, shipped or written by ``mbkf tune``)."""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from mbkf.conventions import data_folder
from mbkf.io import fields
from mbkf.io.toml import Entries, write_toml

FOLDER_VARIABLE = "MBKF_PRESETS"
"""Environment variable that names the folder of named presets."""

SUFFIX = ".toml"

_NAME = fields.text("name", "its name; by default that of the file", empty=True)
_FILTER = fields.text("filter", "the filter it is for", required=True)
_VALUES = fields.part("values", "settings by name", "[values]", required=True)
_VERSION = fields.text("version", "version of mbkf that found it", empty=True)
_NOTE = fields.text("note", "remark", empty=True)
_TUNED_ON = fields.texts("tuned_on", "trials of the search")
_HELD_OUT = fields.texts("held_out", "trials of its validation")
_SOURCE = fields.text("source", "where the settings are printed", empty=True)
_FOUND = fields.part("found", "result of a search that did no better", "[found]")
_LIKELIHOOD = fields.part("likelihood", "log-likelihoods per reading, nats", "[likelihood]")
PRESET = fields.record(
    "preset",
    _NAME,
    _FILTER,
    _VALUES,
    _VERSION,
    _NOTE,
    _SOURCE,
    _TUNED_ON,
    _HELD_OUT,
    _FOUND,
    _LIKELIHOOD,
)
"""Entries of a preset file."""

Value = float | str | bool | tuple[float, ...]
"""A setting as a file holds it."""


def setting_value(value: object) -> Value | None:
    """A setting of plain data: a number (inf is one), a word, true or false, numbers; None for anything else."""
    if isinstance(value, bool) or (isinstance(value, str) and value):
        return value
    if isinstance(value, int | float):
        return None if math.isnan(value) else float(value)
    if isinstance(value, list) and value:
        numbers = [setting_value(one) for one in value]
        return tuple(one for one in numbers if isinstance(one, float)) if _all_numbers(numbers) else None
    return None


def value_of(text: str) -> Value | None:
    """A setting as a command gives it: as TOML writes it, or a bare word; None for anything else."""
    try:
        found = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError):
        return text if re.fullmatch(r"[A-Za-z]\w*", text) else None
    return setting_value(found["value"]) if len(found) == 1 else None


def _all_numbers(values: list[Value | None]) -> bool:
    return all(isinstance(one, float) for one in values)


_VALUE: fields.Field[Value] = fields.Field(
    "value", "a setting", "a number, a word, true or false, or a list of numbers", setting_value
)
_NUMBER = fields.number("value", "a result of a search")


@dataclass(frozen=True)
class Preset:
    """Settings of a filter under a name.

    Attributes:
        name: Its name.
        filter: The filter they are for.
        values: Settings by name: numbers, words, true or false; those that differ from the defaults or were tried.
        version: Of mbkf when they were found.
        note: Remark for the user.
        tuned_on, held_out: Trials of the search, and of its validation.
        found: Result of the search, where it did no better on the held-out trials and ``values`` stayed.
        likelihood: Log-likelihoods per reading by name, in nats.
        source: Where the settings are printed; empty for those of a search.
    """

    name: str
    filter: str
    values: Mapping[str, Value]
    version: str = ""
    note: str = ""
    tuned_on: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    found: Mapping[str, float] = field(default_factory=dict)
    likelihood: Mapping[str, float] = field(default_factory=dict)
    source: str = ""


def preset_folder() -> Path:
    """Folder of named presets: ``$MBKF_PRESETS``, else ``mbkf/presets`` in ``$XDG_CONFIG_HOME`` or ``~/.config``."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "mbkf" / "presets"


def shipped_presets() -> dict[str, Path]:
    """Files of the presets that come with mbkf by name."""
    files = (data_folder("models") / "presets").glob(f"*{SUFFIX}")
    return {path.stem: path for path in sorted(files, key=lambda path: path.stem)}


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
        UnknownEntry: It has an entry that presets do not have.
        FileFormatError: The file is missing, not TOML, or lacks or misuses an entry.
    """
    read = Entries.of_file(PRESET, path, "a preset file", "make it with 'mbkf tune'")
    read.need(_VALUES)
    return Preset(
        name=read.get(_NAME) or Path(path).stem,
        filter=read.need(_FILTER),
        values=read.by_name(_VALUES, _VALUE),
        version=read.get(_VERSION) or "",
        note=read.get(_NOTE) or "",
        tuned_on=read.get(_TUNED_ON) or (),
        held_out=read.get(_HELD_OUT) or (),
        found=read.by_name(_FOUND, _NUMBER),
        likelihood=read.by_name(_LIKELIHOOD, _NUMBER),
        source=read.get(_SOURCE) or "",
    )
