"""A late change is laid over others: each field by itself, and a field that both changed differently is reported."""

from hypothesis import example, given
from hypothesis import strategies as st

from mbkf.io.merging import Difference, merged

BASE = {"name": "A", "mass_kg": 70.0, "trial": {"walk1": {"kind": "walk", "excluded": "fell"}}}
VALUES = st.one_of(st.none(), st.integers(0, 2), st.lists(st.integers(0, 1), max_size=2))
TABLES = st.dictionaries(st.sampled_from("abc"), VALUES | st.dictionaries(st.sampled_from("xy"), VALUES))


def test_changes_of_other_fields_are_kept():
    mine = {**BASE, "mass_kg": 71.0}
    theirs = {
        "name": "A",
        "mass_kg": 70.0,
        "age": 30.0,
        "trial": {"walk1": {"kind": "run", "excluded": "fell"}},
    }
    found = merged(BASE, mine, theirs)
    assert found.table == {**theirs, "mass_kg": 71.0} and found.differences == ()


def test_a_removed_field_is_removed_and_its_table_with_it():
    found = merged(BASE, {"name": "A", "mass_kg": 70.0}, {**BASE, "sex": "male"})
    assert found.table == {"name": "A", "mass_kg": 70.0, "sex": "male"} and found.differences == ()


def test_a_field_that_both_changed_is_reported_and_keeps_the_present_value():
    found = merged(BASE, {**BASE, "name": "B", "mass_kg": 71.0}, {**BASE, "name": "C"})
    assert found.table == {**BASE, "name": "C", "mass_kg": 71.0}
    assert found.differences == (Difference(("name",), "A", "B", "C"),)
    removed = merged(BASE, {**BASE, "mass_kg": None}, {**BASE, "mass_kg": 80.0})
    assert removed.differences == (Difference(("mass_kg",), 70.0, None, 80.0),)


def test_the_same_change_twice_is_no_difference():
    assert merged(BASE, {**BASE, "name": "B"}, {**BASE, "name": "B"}).differences == ()


@given(TABLES, TABLES)
@example({"b": 0}, {"b": {"x": None}})
def test_without_another_change_mine_stands_and_without_mine_theirs(base, other):
    def plain(table):
        return merged({}, table, {}).table

    assert merged(base, other, base).table == plain(other)
    assert merged(base, base, other).table == plain(other)
    assert merged(base, other, base).differences == merged(base, base, other).differences == ()


@given(TABLES, TABLES, TABLES)
def test_fields_of_both_are_symmetric_but_for_differences(base, one, other):
    there, back = merged(base, one, other), merged(base, other, one)
    assert {d.field for d in there.differences} == {d.field for d in back.differences}
    if not there.differences:
        assert there.table == back.table
