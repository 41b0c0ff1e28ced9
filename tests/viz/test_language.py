"""Every language has every word, with the same places to fill."""

import re

import pytest

from mbkf.errors import InvalidInput
from mbkf.viz.language import ENGLISH, FOLDER, filled, languages, words

SECTIONS = re.findall(r"^\[(\w+)\]", (FOLDER / f"{ENGLISH}.toml").read_text(encoding="utf-8"), re.M)


def test_languages_have_their_own_names():
    assert dict(languages()) == {"en": "English", "es": "Español"}


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("language", sorted(languages()))
def test_every_language_has_every_word(language, section):
    english, other = words(ENGLISH, section), words(language, section)
    assert list(other) == list(english)
    for name, text in english.items():
        assert sorted(re.findall(r"\{\d\}", text)) == sorted(re.findall(r"\{\d\}", other[name])), name
        assert other[name].strip() == other[name] != ""


def test_places_are_filled():
    assert filled("{0} of {1}", 3, "four") == "3 of four"


def test_an_unknown_language_is_refused():
    with pytest.raises(InvalidInput, match="no language 'xx'; choose en, es"):
        words("xx", "app")
