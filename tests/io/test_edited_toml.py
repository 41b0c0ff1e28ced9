"""Entries of a TOML file change, and the words of people stay."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from mbkf.io.edited_toml import edited_toml
from mbkf.io.toml import toml_text

BY_HAND = """# Anna, after the operation
name = "Anna"   # as in the record

mass_kg = 71.5  # without shoes

# She stumbled here.
[trial.walk1]
excluded = "stumbled"  # ask the physiotherapist

[trial.walk2]
kind = "walk"

[[trial.walk2.events]]
side = "r"  # seen in the video
time_s = 0.5
"""


def changed(table):
    return edited_toml(BY_HAND, toml_text("A session", table))


def test_entries_change_and_comments_order_and_blank_lines_stay():
    table = tomllib.loads(BY_HAND)
    assert changed(table) == BY_HAND
    table["mass_kg"] = 72.0
    assert changed(table) == BY_HAND.replace("71.5", "72.0")
    table["trial"]["walk1"]["kind"] = "run"
    table["trial"]["walk3"] = {"excluded": "fell"}
    table["age"] = 30.0
    found = changed(table)
    assert tomllib.loads(found) == table
    assert all(line.replace("71.5", "72.0") in found for line in BY_HAND.splitlines())
    del table["trial"]["walk1"], table["name"]
    found = changed(table)
    assert tomllib.loads(found) == table and "# without shoes" in found and "physiotherapist" not in found


def test_another_text_takes_the_place_of_one_that_is_not_toml():
    written = toml_text("A session", {"name": "Anna"})
    assert edited_toml("name = ", written) == written


VALUES = st.one_of(st.text(max_size=4), st.integers(-9, 9), st.booleans(), st.floats(-2.0, 2.0))
KEYS = st.sampled_from(["a", "b", "c d", "é", "trial"])
EVENTS = st.lists(st.dictionaries(KEYS, VALUES, min_size=1, max_size=2), min_size=1, max_size=2)
TABLES = st.recursive(
    st.dictionaries(KEYS, VALUES, max_size=3),
    lambda inner: st.dictionaries(KEYS, st.one_of(VALUES, EVENTS, inner), max_size=3),
    max_leaves=6,
)


@given(TABLES, TABLES)
def test_the_new_entries_are_those_of_the_table_whatever_stood_there(before, after):
    written = toml_text("new", after)
    found = edited_toml(toml_text("old", before), written)
    assert tomllib.loads(found) == tomllib.loads(written)
