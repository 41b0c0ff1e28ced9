"""Settings of a reconstruction from a preset: one that comes with mbkf, one of the user's own, or a file."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.filters.settings import changed, flat
from mbkf.filters.torque.settings import SCHEMES, preset
from mbkf.io.preset import SUFFIX, Preset, preset_folder, read_preset, saved_presets
from mbkf.trial.preparation.filters import FILTERS
from mbkf.trial.preparation.settings import ReconstructSettings

SettingsT = TypeVar("SettingsT")

LITERAL = "-literal"
BUILT_IN = tuple(name + end for name in SCHEMES for end in ("", LITERAL))
"""Presets that come with mbkf: the thesis's two torque filters, with stable noise and with the thesis's own."""


def with_preset(
    settings: ReconstructSettings, name: str, wanted_filter: str | None = None
) -> ReconstructSettings:
    """Settings with a preset's filter and its values.

    Args:
        settings: All else.
        name: Name of a preset, or a file.
        wanted_filter: The filter chosen by the user; None: the preset's.

    Raises:
        UnknownName: The preset, filter or setting does not exist.
        FileFormatError: The file does not hold a preset.
        InvalidInput: The preset is for another filter than the one chosen, or a value is not possible.
    """
    if name in BUILT_IN:
        _check_filter(name, "torque", wanted_filter)
        scheme = name.removesuffix(LITERAL)
        return replace(settings, filter="torque", torque=preset(scheme, literal=name != scheme))
    path = preset_path(name)
    found = read_preset(path)
    if found.filter not in FILTERS:
        raise UnknownName("filter", found.filter, FILTERS, str(path))
    _check_filter(name, found.filter, wanted_filter)
    own = with_values(getattr(settings, found.filter), found, str(path))
    changes: dict[str, Any] = {"filter": found.filter, found.filter: own}
    return replace(settings, **changes)


def with_values(settings: SettingsT, found: Preset, where: str) -> SettingsT:
    """A filter's settings with the preset's values.

    Args:
        settings: Settings of a filter.
        found: The preset.
        where: Name of the preset, for error messages.

    Raises:
        UnknownName: The setting does not exist, or its value has another type.
        InvalidInput: A value is not positive.
    """
    kinds = {key: type(value) for key, value in flat(settings).items() if isinstance(value, int | float)}
    known = [key for key, kind in kinds.items() if kind is not bool]
    values: dict[str, float] = {}
    for key, value in found.values.items():
        if key not in known:
            raise UnknownName("setting", key, known, where)
        if value <= 0.0 and not (value == 0.0 and key == "innovation_share"):
            raise InvalidInput(f"{where}: {key} must be positive, got {value:g}")
        values[key] = kinds[key](value)
    return changed(settings, **values)


def preset_path(name: str) -> Path:
    """Where a preset that was given by name or as a file lies.

    Raises:
        UnknownName: No preset has this name.
    """
    if name.endswith(SUFFIX) or os.sep in name or "/" in name:
        return Path(name)
    saved = saved_presets()
    if name not in saved:
        where = f"--preset (saved ones lie in {preset_folder()}; a file ends in {SUFFIX})"
        raise UnknownName("preset", name, (*saved, *BUILT_IN), where)
    return saved[name]


def check_name(name: str) -> str:
    """A name under which a preset can be saved.

    Raises:
        InvalidInput: It is not made of letters, digits, dots, dashes and underscores, or mbkf's own.
    """
    if not re.fullmatch(r"\w[\w.-]*", name) or name.endswith(SUFFIX):
        raise InvalidInput(f"--name '{name}': use letters, digits, dashes, underscores and no '{SUFFIX}'")
    if name in BUILT_IN:
        raise InvalidInput(f"--name '{name}' is a preset of mbkf itself; choose another name")
    return name


def place_of(name: str, out: str | Path | None) -> Path:
    """The file a preset will be written to: ``out``, else its name in the user's folder.

    Raises:
        FileFormatError: A folder stands there.
    """
    path = preset_folder() / f"{name}{SUFFIX}" if out is None else Path(out)
    if path.is_dir():
        raise FileFormatError(path, "is a folder; name a file for --out")
    return path


def _check_filter(name: str, its_filter: str, wanted: str | None) -> None:
    if wanted not in (None, its_filter):
        raise InvalidInput(
            f"preset '{name}' is for the {its_filter} filter, not the {wanted} one; leave --filter away"
        )
