"""Rows of wrong persons: pairs are of two persons, a missed one and an accused one fail their rows."""

from pathlib import Path

from benchmarks.verdict.persons import PUBLIC, Accused, Pair, pairs, person_rows

DATA = Path("data")


def test_pairs_of_two_persons_have_another_person_s_file():
    found = pairs(DATA)
    assert all(trial not in files for trial, files in PUBLIC.items())
    assert sum(not one.own and one.plates for one in found) == sum(map(len, PUBLIC.values())) >= 30
    assert len(set(found)) == len(found)


def test_a_missed_wrong_person_and_an_accused_right_one_fail():
    wrong, right = Pair("HC032A", "HC044A", DATA), Pair("bmc", "bmc", DATA)
    alone, made = Pair("HC032A", "HC044A", DATA, plates=False), Pair("31", "32", DATA, plates=False)
    reported = [Accused(one, "do not use", 14.0, "") for one in (wrong, alone, made)]
    assert all(one.value in (0, 100.0) for one in person_rows([*reported, Accused(right, "use", 0.0, "")]))
    missed = [one for one in person_rows([Accused(wrong, "use", 1.0, ""), *reported[1:]]) if one.value == 0.0]
    assert [one.relation for one in missed] == [">=", "<=", "<="] and "with plates" in missed[0].name
    accused = list(person_rows([*reported, Accused(right, "look", 3.0, "look: it")]))
    assert [one.value for one in accused if one.name.startswith("right persons accused (public")] == [1]
