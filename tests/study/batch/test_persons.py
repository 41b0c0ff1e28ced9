"""Persons of one folder: told apart by subjects in files, codes in file names and sizes, and by nothing else."""

from pathlib import Path

import pytest

from mbkf.io.c3d_person import StatedPerson
from mbkf.study.batch.folder import is_static
from mbkf.study.batch.persons import persons_of_files


def found(stems, **stated):
    """Labels with the stems of their captures, and the stems that are nobody's for certain."""
    captures = [Path(f"{stem}.c3d") for stem in stems.split()]
    facts = {
        path: StatedPerson(*one) for path in captures if (one := stated.get(path.stem.replace("-", "_")))
    }
    statics = {path for path in captures if is_static(path)}
    result = persons_of_files(captures, statics, lambda path: facts.get(path, StatedPerson()))
    persons = {one.label: [path.stem for path in one.captures] for one in result.persons}
    return persons, [path.stem for path in result.unknown]


@pytest.mark.parametrize(
    "stems",
    ["P01_static P01_walk P02_static P02_walk", "P01-static P01-walk1 P02-walk1", "P01_walk P02_walk",
     "static_P01 walk1_P01 static_P02 walk1_P02", "P01static P01walk1 P02static P02walk1",
     "p01_static P01_walk p02_walk", "20140515T133244_static 20140515T133244_run 20140612T1_static 20140612T1_run",
     "HC032A_Static_HC032A01 HC032A_Straight_HC032A03 HC044A_Static_HC044A01 HC044A_Straight_HC044A15",
     "HC032A_static HC032A_walk 2014001_ST_static 2014001_C1_01",
     "anna_static anna_walk ben_static ben_walk", "stephan_static stephan_walk anna_static anna_walk",
     "100433_static 100433_run 100434_static 100434_run"],
)  # fmt: skip
def test_codes_and_shared_words_tell_two_persons_apart(stems):
    persons, unknown = found(stems)
    assert len(persons) == 2 and not unknown
    for label, own in persons.items():
        assert own and all(label.casefold() in stem.casefold() for stem in own)


@pytest.mark.parametrize(
    "stems",
    ["static walk1 walk2", "static_001 static_002 walk_001 walk_002",
     "static_01 static_02 walk_01 walk_02", "walk1_left walk1_right walk2_left static",
     "slow_static slow_walk fast_static fast_walk", "101500_static 101730_walk1 102000_walk2",
     "S1_FlywheelSquat S1_StandingRef", "trial01_a trial02_a", "2014001_C1_01 2014001_ST_static",
     "T1_walk T2_walk T3_static", "marche1_a marche2_a static",
     "day1_static day1_walk day2_static day2_walk", "hop_a kick_a static"],
)  # fmt: skip
def test_tasks_conditions_and_numbers_of_trials_are_no_persons(stems):
    assert found(stems) == ({"": stems.split()}, [])


def test_subjects_named_in_the_files_are_persons_where_each_has_a_standing_trial():
    one, other = (("Anna",), None, None), (("Ben",), None, None)
    persons, unknown = found("static1 static2 w1 w2", static1=one, static2=other, w1=one, w2=other)
    assert persons == {"Anna": ["static1", "w1"], "Ben": ["static2", "w2"]} and not unknown


def test_a_marker_set_s_name_in_the_place_of_a_subject_is_no_person_but_reported():
    captures = [Path("static.c3d"), Path("landing.c3d")]
    names = {"static": "Treadmill", "landing": "FullBody"}
    result = persons_of_files(captures, captures[:1], lambda path: StatedPerson((names[path.stem],)))
    assert [one.captures for one in result.persons] == [tuple(captures)]
    assert result.subjects == ("Treadmill", "FullBody")


def test_codes_as_subjects_are_persons_without_standing_trials():
    persons, _ = found("a b", a=(("P01",),), b=(("P02",),))
    assert persons == {"P01": ["a"], "P02": ["b"]}


def test_masses_and_heights_that_differ_are_different_persons_and_a_silent_file_is_nobody_s():
    child, adult = ((), 39.4, None), ((), 60.3, None)
    persons, unknown = found("static w1 w2 w3", static=adult, w1=child, w2=((), 60.0, None))
    assert persons == {"60.3kg": ["static", "w2"], "39.4kg": ["w1"]} and unknown == ["w3"]
    tall, small = ((), None, 1.80), ((), None, 1.62)
    assert list(found("static w1", static=tall, w1=small)[0]) == ["1.80m", "1.62m"]


def test_rounded_masses_and_heights_are_one_person_s():
    assert found("static w1", static=((), 60.3, 1.584), w1=((), 61.0, 1.60)) == ({"": ["static", "w1"]}, [])


def test_a_capture_without_a_code_beside_two_coded_standing_trials_is_nobody_s():
    persons, unknown = found("P01_static P02_static P01_walk walk7")
    assert persons == {"P01": ["P01_static", "P01_walk"], "P02": ["P02_static"]} and unknown == ["walk7"]


def test_one_code_with_two_masses_is_two_persons():
    persons, _ = found("P01_static P01_walk", P01_static=((), 60.0, None), P01_walk=((), 80.0, None))
    assert list(persons) == ["60.0kg", "80.0kg"]
