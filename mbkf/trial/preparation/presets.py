"""Settings of a reconstruction from a preset: one that comes with mbkf, one of the user's own, or a file."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.filters.given_settings import with_given
from mbkf.filters.settings import flat
from mbkf.io.preset import (
    SUFFIX,
    Value,
    preset_folder,
    read_preset,
    saved_presets,
    shipped_presets,
    value_of,
)
from mbkf.trial.preparation.filters import FILTERS
from mbkf.trial.preparation.settings import ReconstructSettings


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
    path = preset_path(name)
    found = read_preset(path)
    if found.filter not in FILTERS:
        raise UnknownName("filter", found.filter, FILTERS, str(path))
    if wanted_filter not in (None, found.filter):
        raise InvalidInput(
            f"preset '{name}' is for the {found.filter} filter, not the {wanted_filter} one; leave --filter away"
        )
    own = with_given(getattr(settings, found.filter), found.values, str(path))
    changes: dict[str, Any] = {"filter": found.filter, found.filter: own, "preset": Path(name).name}
    return replace(settings, **changes)


def with_set(settings: ReconstructSettings, given: Sequence[str]) -> ReconstructSettings:
    """Settings with single ones of the chosen filter changed.

    Args:
        settings: All else.
        given: Texts ``NAME=VALUE``, as ``--set`` takes them.

    Raises:
        UnknownName: The setting does not exist.
        InvalidInput: A text has another form, names a setting twice or one of another filter, or a value is not
            possible.
    """
    if not given:
        return settings
    values: dict[str, Value] = {}
    for text in given:
        name, equals, written = (part.strip() for part in text.partition("="))
        value = value_of(written)
        if not (name and equals) or value is None:
            raise InvalidInput(f"--set '{text}': write NAME=VALUE, such as integrator=HE or plate_force_n=10")
        if name in values:
            raise InvalidInput(f"--set {name} is given twice; give it once")
        values[name] = value
    own = getattr(settings, settings.filter)
    for name in values:
        if name not in flat(own):
            _refuse_other_filters(settings, name)
    changes: dict[str, Any] = {settings.filter: with_given(own, values, "--set")}
    return replace(settings, **changes, given=tuple(values.items()))


def _refuse_other_filters(settings: ReconstructSettings, name: str) -> None:
    """Refuses a name that is, or is nearest to, a setting of another filter than the chosen one."""
    known = {one: flat(getattr(settings, one)) for one in (settings.filter, *FILTERS)}
    near = difflib.get_close_matches(name, dict.fromkeys(key for keys in known.values() for key in keys), 1)
    if not near or near[0] in known[settings.filter]:
        return
    others = [one for one in FILTERS if near[0] in known[one]]
    meant = "this" if near[0] == name else f"no filter has this setting; {near[0]}"
    raise InvalidInput(
        f"--set {name}: {meant} is a setting of the {' and the '.join(others)} filter, and the {settings.filter} "
        f"filter was chosen; give --filter {others[0]}"
    )


def preset_path(name: str) -> Path:
    """Where a preset that was given by name or as a file lies.

    Raises:
        UnknownName: No preset has this name.
    """
    shipped = shipped_presets()
    if name in shipped:
        return shipped[name]
    if name.endswith(SUFFIX) or os.sep in name or "/" in name:
        return Path(name)
    saved = saved_presets()
    if name not in saved:
        where = f"--preset (saved ones lie in {preset_folder()}; a file ends in {SUFFIX})"
        raise UnknownName("preset", name, (*saved, *shipped), where)
    return saved[name]


def check_name(name: str) -> str:
    """A name under which a preset can be saved.

    Raises:
        InvalidInput: It is not made of letters, digits, dots, dashes and underscores, or mbkf's own.
    """
    if not re.fullmatch(r"\w[\w.-]*", name) or name.endswith(SUFFIX):
        raise InvalidInput(f"--name '{name}': use letters, digits, dashes, underscores and no '{SUFFIX}'")
    if name in shipped_presets():
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
