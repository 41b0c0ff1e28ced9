"""The verdict's record: words by part, order of reasons, parts that are not shown, plain data and back."""

import json

import pytest

from mbkf.errors import InvalidInput
from mbkf.io.results_h5 import read_h5, write_h5
from mbkf.io.verdict import PARTS, Reason, Verdict, listed
from tests.io.reconstructions import made_up

LEG = Reason("left_leg", "look", "markers 20 mm off", "not posed as they are", "check names", 2.0)
PLATE = Reason("left_leg_loads", "do not use", "plate turned", "wrong shear", "correct corners", 1.5)
GRAVER = Reason("right_leg_loads", "do not use", "mass 40 % off", "wrong torques", "scale again", 3.0)
NO_ARM = Reason("right_arm", "do not use", "nothing of it", "usual posture", "add markers", shown=False)


def test_without_reasons_everything_may_be_used():
    found = Verdict()
    assert found.overall == found.line == "use"
    assert found.parts == dict.fromkeys(PARTS, "use")
    assert found.loads_usable and found.shown == PARTS and found.sentences == ()


def test_the_gravest_word_is_a_part_s_and_the_trial_s():
    found = Verdict.of([LEG, PLATE])
    assert found.overall == "do not use"
    assert (found.parts["left_leg"], found.parts["left_leg_loads"], found.parts["trunk"]) == (
        "look", "do not use", "use",
    )  # fmt: skip
    assert not found.loads_usable
    assert Verdict.of([LEG]).overall == "look" and Verdict.of([LEG]).loads_usable


def test_reasons_stand_by_word_then_weight():
    assert Verdict.of([NO_ARM, LEG, PLATE, GRAVER]).reasons == (GRAVER, PLATE, LEG, NO_ARM)


def test_a_part_that_is_not_shown_makes_no_trial_worse():
    found = Verdict.of([NO_ARM])
    assert found.overall == "use" and found.parts["right_arm"] == "do not use"
    assert found.line == "use (not shown: right arm)"
    assert not found.may_use("right_arm") and found.may_use("left_arm")
    unread = Reason("trunk_loads", "do not use", "no plates", "assumed", "use plates", shown=False)
    assert Verdict.of([unread]).loads_usable


def test_a_trial_that_shows_nothing_is_not_to_be_used():
    nothing = [Reason(part, "do not use", "nothing", "nothing", "record", shown=False) for part in PARTS]
    assert Verdict.of(nothing).overall == "do not use"


def test_the_line_names_word_parts_and_the_gravest_reason():
    found = Verdict.of([LEG, PLATE, GRAVER])
    assert found.line == ("do not use: loads of both legs; mass 40 % off: wrong torques; scale again")
    assert (
        found.sentences[0] == "do not use: loads of the right leg; mass 40 % off: wrong torques; scale again"
    )
    assert len(found.sentences) == 3


def test_both_sides_of_a_pair_stand_together():
    assert listed(["left_arm", "pelvis", "right_arm"]) == "pelvis, both arms"
    assert listed(["left_leg", "right_leg_loads"]) == "left leg, loads of the right leg"


def test_plain_data_go_there_and_back():
    found = Verdict.of([LEG, PLATE, NO_ARM])
    table = json.loads(json.dumps(found.as_table()))
    assert Verdict.of_table(table) == found
    assert set(table) == {"overall", "parts", "reasons"}
    assert set(table["reasons"][0]) == {"part", "word", "found", "means", "do", "weight", "shown"}
    with pytest.raises(InvalidInput, match="cannot be read as a list of reasons"):
        Verdict.of_table({"reasons": [{"part": "trunk"}]})


@pytest.mark.parametrize("verdict", [None, Verdict(), Verdict.of([LEG, NO_ARM])])
def test_a_result_s_file_keeps_it(verdict, tmp_path):
    write_h5(made_up(verdict=verdict), tmp_path / "motion.h5")
    assert read_h5(tmp_path / "motion.h5").verdict == verdict


@pytest.mark.parametrize(("part", "word"), [("tail", "use"), ("trunk", "maybe")])
def test_unknown_parts_and_words_are_refused(part, word):
    with pytest.raises(InvalidInput, match="unknown part"):
        Reason(part, word, "", "", "")
