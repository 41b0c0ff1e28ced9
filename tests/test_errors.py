"""An error's text stays short and steers no terminal, whatever a damaged file put into it."""

from pathlib import Path

import pytest

from mbkf.errors import (
    MOST_LETTERS,
    FileFormatError,
    InvalidInput,
    UnknownEntry,
    UnknownName,
    suggestion,
)


def test_texts_are_cut_and_letters_that_steer_terminals_are_shown_as_codes():
    assert str(InvalidInput("the mass is 3 kg; give µT, «x»")) == "the mass is 3 kg; give µT, «x»"
    assert str(FileFormatError("a.trc", "\x1b[2Jhello\x07", 3)) == r"a.trc, line 3: \x1b[2Jhello\x07"
    assert str(InvalidInput("two\nlines\r\nand more")) == "two lines and more"
    long = str(UnknownName("marker", 10_000 * "x" + "!", ["end"]))
    assert MOST_LETTERS < len(long) < MOST_LETTERS + 10
    assert long.startswith("unknown marker 'xxx") and long.endswith("!'; known are end")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("Mass (kg)", "did you mean mass_kg"),
        ("MASS_KG", "did you mean mass_kg"),
        ("weight", "did you mean mass_kg"),
        ("heigth", "did you mean height_m"),
        ("Gender", "did you mean sex"),
        ("colour", "known are mass_kg, height_m, sex"),
    ],
)
def test_the_nearest_name_is_found_whatever_its_capitals_and_marks(name, found):
    assert suggestion(name, ("mass_kg", "height_m", "sex")) == found


def test_an_unknown_entry_is_both_a_damaged_file_and_an_unknown_name():
    error = UnknownEntry("a.toml", "session entry", "mass", ("mass_kg",), 3)
    assert isinstance(error, FileFormatError) and isinstance(error, UnknownName)
    assert (error.path, error.line, error.name, error.choices) == (Path("a.toml"), 3, "mass", ("mass_kg",))
    assert str(error) == "a.toml, line 3: unknown session entry 'mass'; did you mean mass_kg"
    assert str(UnknownEntry("a.toml", "entry", "x", ())).startswith("a.toml: unknown entry 'x'")
