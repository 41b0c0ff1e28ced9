"""Texts of pages and reports in each language, from the files of ``mbkf/viz/languages``.

A language is a TOML file named after its code, with the language's own name and a section of texts for each kind of
page. A new language needs such a file only; tests keep every file complete.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from mbkf.errors import InvalidInput

FOLDER = Path(__file__).resolve().parent / "languages"

ENGLISH = "en"
"""The language of texts without a translation."""


@cache
def languages() -> Mapping[str, str]:
    """The languages by code, e.g. "es": "Español"."""
    return {path.stem: _read(path.stem)["name"] for path in sorted(FOLDER.glob("*.toml"))}


def words(language: str, section: str) -> Mapping[str, str]:
    """The texts of a section, e.g. "app", in the language of a code, e.g. "es".

    Raises:
        InvalidInput: The language does not exist.
    """
    if language not in languages():
        raise InvalidInput(f"there is no language '{language}'; choose {', '.join(languages())}")
    return _read(language)[section]


@cache
def decimal_sign(language: str) -> str:
    """The sign between whole and decimal places, e.g. "," in Spanish."""
    return str(_read(language)["decimal"])


def contractions(language: str) -> Mapping[str, str]:
    """Words of a language that are written together, by themselves apart."""
    return dict(_read(language)["contractions"])


def filled(text: str, *values: object) -> str:
    """A text with values in the places of {0}, {1} and so on."""
    for k, value in enumerate(values):
        text = text.replace(f"{{{k}}}", str(value))
    return text


@cache
def _read(language: str) -> dict:
    return tomllib.loads((FOLDER / f"{language}.toml").read_text(encoding="utf-8"))
