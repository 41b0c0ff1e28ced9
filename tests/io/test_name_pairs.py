"""Affixes that tell the markers of persons apart."""

import pytest

from mbkf.io.name_pairs import Affix, own_affix, without_number


@pytest.mark.parametrize(
    ("affix", "name", "base"),
    [
        (Affix("A", True), "A_LASI", "LASI"),
        (Affix("_B", False), "LASI_B", "LASI"),
        (Affix("", True), "LASI", "LASI"),
        (Affix("A", True), "A", "A"),
        (Affix("B", False), "RASI", "RASI"),
    ],
)
def test_a_name_loses_the_affix_that_it_carries(affix, name, base):
    assert affix.base(name) == base


def test_a_person_s_affix_is_on_most_of_the_own_names_and_rare_on_others():
    own, others = [f"S1.{name}" for name in ("LASI", "RASI", "C7")], [["S2.LASI", "S2.C7"]]
    assert own_affix(own, others).word == "S1"
    assert own_affix(["LASI", "LKNE", "LTOE"], [["RASI"]]) == Affix("", True)
    assert own_affix(own, [own]) == Affix("", True)


def test_numbers_are_not_cut():
    assert own_affix([f"M{k:02d}" for k in range(9)], [["LASI"]]) == Affix("", True)


def test_only_numbers_that_a_reader_gave_are_taken_away():
    assert without_number("C7_2", {"C7_2", "THI_3"}, {"C7"}) == "C7"
    assert without_number("THI_3", {"C7_2", "THI_3"}, {"C7"}) == "THI_3"
    assert without_number("C7_2", {"C7_2", "C7"}, {"C7"}) == "C7_2"
