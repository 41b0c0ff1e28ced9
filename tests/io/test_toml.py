"""TOML files: plain values come back as they were, and entries that are not what they must be are refused."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, InvalidInput
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


def entries(**table) -> Entries:
    return Entries(Path("a.toml"), table, "part: ")


def test_entries_are_what_they_must_be_or_missing():
    read = entries(text="x", number=2, numbers=[1, 2.5], word="a", tables={"b": {"n": 1}}, listed=[{"n": 2}])
    assert (read.text("text"), read.number("number", (0, 3)), read.one_of("word", ("a", "b"))) == (
        "x",
        2.0,
        "a",
    )
    np.testing.assert_array_equal(read.numbers("numbers", 2, 3.0), [1.0, 2.5])
    assert read.tables("tables")["b"].number("n") == 1.0
    assert [one.number("n") for one in read.list_of_tables("listed")] == [2.0]
    missing = (read.text("x"), read.number("x"), read.numbers("x", 1, 1.0), read.list_of_tables("x"))
    assert missing == (None, None, None, None) and read.tables("x") == {}
    assert read.required("text", read.text("text")) == "x"
    with pytest.raises(FileFormatError, match=r"a\.toml: part: x is missing"):
        read.required("x", read.text("x"))


@pytest.mark.parametrize(
    ("value", "ask", "reason"),
    [
        ("", lambda read: read.text("x"), "must be a text, got"),
        (True, lambda read: read.number("x"), "must be a number, got True"),
        (float("nan"), lambda read: read.number("x"), "must be a number, got nan"),
        (4, lambda read: read.number("x", (0.0, 3.0)), "must be a number between 0 and 3, got 4"),
        ([1.0], lambda read: read.numbers("x", 2, 9.0), "must be 2 numbers"),
        ([1.0, 10.0], lambda read: read.numbers("x", 2, 9.0), "must be 2 numbers"),
        ([1.0, True], lambda read: read.numbers("x", 2, 9.0), "must be 2 numbers"),
        ("c" * 100, lambda read: read.one_of("x", ("a", "b")), "must be one of a, b, got c+ …"),
        ([1], lambda read: read.list_of_tables("x"), r"must be a list of tables, \[\[x\]\]"),
        ({"a": 1}, lambda read: read.tables("x"), r"must hold tables, \[x.NAME\]"),
    ],
)
def test_other_entries_are_refused_with_their_place(value, ask, reason):
    with pytest.raises(FileFormatError, match=f"a.toml: part: x {reason}"):
        ask(entries(x=value))


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
