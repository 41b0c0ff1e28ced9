"""TOML files: plain values come back as they were, and entries that are not what they must be are refused."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io import fields
from mbkf.io.toml import Entries, one_line_errors, write_toml

TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
PLAIN = st.booleans() | st.integers(-(2**60), 2**60) | st.floats(allow_nan=False) | TEXT
VALUES = st.recursive(
    PLAIN,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3),
    max_leaves=8,
)


def has_mixed_list(value):
    """True for lists of tables and other values, which no file of ours has."""
    if isinstance(value, dict):
        return any(map(has_mixed_list, value.values()))
    if not isinstance(value, list):
        return False
    tables = [isinstance(one, dict) for one in value]
    return (any(tables) and not all(tables)) or any(
        has_mixed_list(one) or (isinstance(one, list) and holds_table(one)) for one in value
    )


def holds_table(value):
    return isinstance(value, dict) or (isinstance(value, list) and any(map(holds_table, value)))


@given(table=st.dictionaries(TEXT, VALUES, max_size=4).filter(lambda table: not has_mixed_list(table)))
def test_plain_values_come_back(tmp_path_factory, table):
    path = tmp_path_factory.mktemp("toml") / "a.toml"
    write_toml(path, "values", table)
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# values\n") and tomllib.loads(text) == table


def test_arrays_numbers_of_numpy_and_missing_entries(tmp_path):
    table = {"a": np.eye(2), "b": np.float32(0.5), "c": np.int64(3), "d": None, "e": (), "f": np.bool_(True)}
    write_toml(tmp_path / "a.toml", "arrays", table)
    found = tomllib.loads((tmp_path / "a.toml").read_text())
    assert found == {"a": [[1.0, 0.0], [0.0, 1.0]], "b": 0.5, "c": 3, "e": [], "f": True}


NAME = fields.text("name", "a name", required=True)
SIZE = fields.number("size_m", "a size", (0.0, 3.0), "m")
PLACE = fields.numbers("place_m", "a place", 2, 9.0, "m")
KIND = fields.word("kind", "a kind", ("a", "b"))
FREE = fields.part("free", "numbers by name", "[free]")
PARTS = fields.part("parts", "tables by name", "[parts.NAME]")
LISTED = fields.part("listed", "tables", "[[listed]]")
INNER = fields.record("inner table", SIZE)
OUTER = fields.record("test file", NAME, SIZE, PLACE, KIND, FREE, PARTS, LISTED)


def of_text(tmp_path, text: str) -> Entries:
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    return Entries.of_file(OUTER, tmp_path / "a.toml", "a test file", "make one")


def test_entries_are_as_declared_or_missing(tmp_path):
    read = of_text(
        tmp_path,
        'name = "x"\nsize_m = 2\nplace_m = [1, 2.5]\nkind = "a"\nfree.n = 1\n'
        "[parts.b]\nsize_m = 1\n[[listed]]\nsize_m = 2\n[[listed]]\n",
    )
    assert (read.need(NAME), read.get(SIZE), read.get(KIND)) == ("x", 2.0, "a")
    np.testing.assert_array_equal(read.get(PLACE), [1.0, 2.5])
    assert read.by_name(FREE, SIZE) == {"n": 1.0}
    assert read.tables(PARTS, INNER)["b"].get(SIZE) == 1.0
    assert [one.get(SIZE) for one in read.list_of_tables(LISTED, INNER)] == [2.0, None]
    empty = of_text(tmp_path, "")
    assert (empty.get(SIZE), empty.get(KIND), empty.list_of_tables(LISTED, INNER)) == (None, None, None)
    assert empty.tables(PARTS, INNER) == empty.by_name(FREE, SIZE) == {}
    with pytest.raises(FileFormatError, match=r"a\.toml: name is missing; it must be a text"):
        empty.get(NAME)
    with pytest.raises(FileFormatError, match="size_m is missing; it must be a number between 0 and 3 m"):
        empty.need(SIZE)


def every(read: Entries) -> None:
    for field in (SIZE, PLACE, KIND):
        read.get(field)
    read.by_name(FREE, SIZE)
    for one in (*read.tables(PARTS, INNER).values(), *(read.list_of_tables(LISTED, INNER) or ())):
        one.get(SIZE)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("size_m = true", "line 1: size_m must be a number between 0 and 3 m, got True"),
        ("\nsize_m = nan", "line 2: size_m must be a number between 0 and 3 m, got nan"),
        (
            "size_m = 4",
            "line 1: size_m must be .*, got 4; write size_m = 0.04 if it is in cm, size_m = 0.004 if it is in mm",
        ),
        ("place_m = [1.0]", "line 1: place_m must be 2 numbers of at most 9 m"),
        ("place_m = [1.0, 10.0]", "line 1: place_m must be 2 numbers"),
        ("place_m = [1.0, true]", "line 1: place_m must be 2 numbers"),
        (f'kind = "{"c" * 100}"', "line 1: kind must be one of a, b, got c+ …"),
        ("kind = [1]", "line 1: kind must be one of a, b"),
        ("listed = [1]", r"line 1: listed must be a list of tables, \[\[listed\]\]"),
        ("parts = {a = 1}", r"line 1: parts must hold tables, \[parts.NAME\]"),
        ("free = 3", r"line 1: free must be a table, \[free\]"),
        ("[free]\nm = 4", "line 2: free: m must be a number between 0 and 3 m"),
        (
            "[[listed]]\n[[listed]]\nsise_m = 1",
            "line 3: unknown inner table entry 'sise_m'; did you mean size_m",
        ),
        ("[parts.x]\nsize_m = 9", "line 2: parts x: size_m must be"),
        ("SIZE_M = 1", "line 1: unknown test file entry 'SIZE_M'; did you mean size_m"),
        ("x = 1", "line 1: unknown test file entry 'x'; known are name, size_m"),
    ],
)
def test_other_entries_are_refused_with_line_and_place(tmp_path, text, reason):
    with pytest.raises(FileFormatError, match=rf"a\.toml, {reason}"):
        every(of_text(tmp_path, text))


@pytest.mark.parametrize(
    ("error", "refusal", "text"),
    [
        (FileNotFoundError(), FileFormatError, "a.toml: no such file; make one"),
        (IsADirectoryError(), FileFormatError, "a.toml: cannot be read, it is a folder; make one"),
        (PermissionError("denied"), FileFormatError, "a.toml: cannot be read (denied)"),
        (KeyError("mass"), FileFormatError, "a.toml: not a test file ('mass'); make one"),
        (InvalidInput("too heavy"), InvalidInput, "a.toml: too heavy"),
    ],
)
def test_errors_of_reading_are_one_line(error, refusal, text):
    with pytest.raises(refusal) as told, one_line_errors(Path("a.toml"), "a test file", "make one"):
        raise error
    assert str(told.value) == text
