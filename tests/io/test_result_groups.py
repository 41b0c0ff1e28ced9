"""Records that make a result: together they have each of its fields once."""

from dataclasses import fields

import pytest

from mbkf.io.dimensions import AXES
from mbkf.io.quantities import attributes, quantities
from mbkf.io.result_groups import GROUPS, SOURCE_CODES
from mbkf.io.results import QUANTITIES, Reconstruction


def test_every_field_of_a_result_stands_in_one_group():
    names = [one.name for group in GROUPS for one in fields(group)]
    assert len(set(names)) == len(names)
    assert set(names) == {one.name for one in fields(Reconstruction)}


@pytest.mark.parametrize("group", GROUPS)
def test_every_field_is_declared(group):
    declared = {*quantities(group), *(one.name for one in attributes(group)), "subject"}
    assert {one.name for one in fields(group)} <= declared


def test_axes_are_known_and_meanings_are_phrases():
    for name, one in QUANTITIES.items():
        assert set(one.axes) <= set(AXES), name
        assert one.meaning and one.meaning[-1] not in ".,;", name
        assert one.is_text or one.unit.text, name
        assert not one.beside or one.beside in QUANTITIES, name


def test_the_axes_of_a_trial_are_labelled_by_its_own_names():
    for axis in {axis for one in QUANTITIES.values() if one.written for axis in one.axes}:
        assert AXES[axis].labels or AXES[axis].names in QUANTITIES, axis


def test_codes_of_sources_are_words():
    assert SOURCE_CODES == {0: "none", 1: "measured", 2: "shared", 3: "estimated"}
