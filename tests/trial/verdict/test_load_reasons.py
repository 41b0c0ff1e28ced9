"""Reasons against loads: checks by their size, unexplained forces by cause and share, contacts, motion below them."""

from dataclasses import replace

import pytest

from mbkf.io.contacts import ContactInterval
from mbkf.io.findings import Finding, judged
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import LOAD_PARTS, MOTION_PARTS, Reason, gravest
from mbkf.scaling.trial_lengths import LengthChange, LengthEvidence
from mbkf.trial.checks import clocks, floor, in_view, lengths, mass, newton, persons, places, rigidity
from mbkf.trial.verdict.evidence import Evidence
from mbkf.trial.verdict.load_reasons import check_reasons, load_reasons

PULL = UnexplainedLoad(1.0, 2.0, (0.0, 0.0, 300.0), 8.0, 0.4, "", "no contact gives it")


def outside(name, value, sd=0.1, unit="%", bound=1.0, hint="it is off; mend it"):
    return judged(name, value, sd, unit, bound, hint)


def words(motion=(), **evidence):
    found = list(load_reasons(Evidence(**evidence), motion))
    return {part: gravest(one.word for one in found if one.part == part) for part in LOAD_PARTS}


def all_of(word):
    return dict.fromkeys(LOAD_PARTS, word)


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        (mass.NAME, 4.0, "use"),
        (mass.NAME, -9.0, "look"),
        (mass.NAME, 53.0, "do not use"),
        (clocks.NAME, 10.0, "use"),
        (clocks.NAME, 21.0, "look"),
        (clocks.NAME, -60.0, "do not use"),
        ("axes of plate '1'", 1.7, "use"),
        ("axes of plate '1'", 5.0, "do not use"),
        (floor.NAME, -104.0, "use"),
        (floor.NAME, 130.0, "look"),
        ("place of plate 'r'", 127.0, "look"),
        ("place of plate 'r'", 200.0, "do not use"),
        ("place of all plates", 55.0, "look"),
        ("place of all plates", 103.0, "do not use"),
        ("order of plates '1' and '2'", 2.5, "look"),
        ("order of plates '1' and '2'", 11.0, "do not use"),
    ],
)
def test_checks_outside_have_words_by_their_size(name, value, word):
    assert words(checks=(outside(name, value),)) == all_of(word)


def test_the_worst_plate_is_named_and_the_others_counted():
    turned = [outside(f"axes of plate '{n}'", value) for n, value in ((1, 5.0), (2, 29.0), (3, 4.0))]
    first = next(load_reasons(Evidence(checks=tuple(turned)), ()))
    assert first.found == "axes of plate '2' +29 %, it is off (and 2 more plates)"
    assert first.do == "mend it"


def test_without_a_trunk_plates_are_not_compared_with_the_motion_of_the_whole_body():
    found = words(checks=(outside(mass.NAME, 30.0),), unshown=("trunk", "trunk_loads"))
    assert found == all_of("use")


def test_newton_s_law_counts_where_no_other_check_explains_it():
    lacks = Finding(newton.FORCE, 47.0, 1.0, "% BW", 10.0, "outside", "of markers alone")
    assert words(checks=(lacks,)) == all_of("do not use")
    assert words(checks=(lacks, outside(mass.NAME, 9.0))) == all_of("look")
    run = Finding(newton.FORCE, 29.0, 9.5, "% BW", 10.0, "outside", "of markers alone")
    assert words(checks=(run,)) == all_of("use")


@pytest.mark.parametrize(("share", "word"), [(0.05, "look"), (0.3, "do not use")])
def test_an_unexplained_force_counts_by_the_frames_that_it_spoils(share, word):
    assert words(unexplained=(PULL,), unexplained_share=share) == all_of(word)


def test_a_wrong_mass_counts_by_its_size():
    light = UnexplainedLoad(0.0, 2.0, (0.0, 0.0, -40.0), 8.0, 0.07, "mass", "scale again")
    heavy = UnexplainedLoad(0.0, 2.0, (0.0, 0.0, -300.0), 8.0, 0.5, "mass", "scale again")
    assert words(unexplained=(light,), unexplained_share=1.0) == all_of("look")
    assert words(unexplained=(heavy,), unexplained_share=0.01) == all_of("do not use")


def test_a_foot_beside_its_plate_spoils_its_own_leg():
    beside = UnexplainedLoad(0.0, 1.0, (0.0, 0.0, 300.0), 8.0, 0.4, "left_foot", "it stands beside")
    assert words(unexplained=(beside,), unexplained_share=0.5) == {
        "right_leg_loads": "look", "left_leg_loads": "do not use", "trunk_loads": "look",
    }  # fmt: skip


def test_a_contact_that_nothing_measures_is_to_be_looked_at():
    seat = ContactInterval("pelvis", 1.0, 2.0, 400.0, 20.0, "estimated")
    hand = ContactInterval("right_hand", 1.0, 2.0, 40.0, 20.0, "estimated")
    found = list(load_reasons(Evidence(contacts=(hand, seat)), ()))
    assert {one.word for one in found} == {"look"}
    assert found[0].found.startswith("the pelvis bears up to 400 N from 1.00 to 2.00 s")
    assert found[0].found.endswith("also right hand") and "--feet-only" in found[0].do


def test_loads_rest_on_the_motion_below_them():
    leg = Reason("left_leg", "do not use", "turned over", "", "")
    assert words([leg]) == {
        "right_leg_loads": "use", "left_leg_loads": "do not use", "trunk_loads": "do not use",
    }  # fmt: skip
    assert words([Reason("pelvis", "look", "doubtful", "", "")]) == all_of("look")
    assert words([Reason("left_arm", "do not use", "turned over", "", "")]) == all_of("use")


def test_loads_that_are_not_shown_have_no_reasons_of_their_own():
    assert words(checks=(outside(mass.NAME, 53.0),), unshown=LOAD_PARTS) == all_of("use")


def test_a_leg_whose_markers_sit_elsewhere_is_not_to_be_used():
    moved = Finding(
        places.NAME, 9.0, 0.6, "times", 2.5, "outside", "half of them; scale again", segment="left_thigh"
    )
    found = check_reasons(Evidence(checks=(moved,), part_of={"left_thigh": "left_leg"}))
    assert {one.part: one.word for one in found} == {"right_leg": "look", "left_leg": "do not use"}
    less = replace(moved, value=1.7)
    found = check_reasons(Evidence(checks=(less,), part_of={"left_thigh": "left_leg"}))
    assert {one.word for one in found} == {"look"}


def test_checks_without_plates_concern_motions():
    loose = Finding(
        rigidity.NAME, 80.0, 6.0, "mm", 30.0, "outside", "LTIB moves; check", segment="left_shank"
    )
    uneven = outside(lengths.NAME, 9.0)
    found = list(check_reasons(Evidence(checks=(loose, uneven), part_of={"left_shank": "left_leg"})))
    assert [(one.part, one.word) for one in found] == [
        ("left_leg", "look"),
        ("right_leg", "look"),
        ("left_leg", "look"),
    ]
    assert list(check_reasons(Evidence(checks=(outside(lengths.NAME, 0.1),)))) == []


@pytest.mark.parametrize(("powers", "word"), [(2.4, "use"), (2.6, "look"), (14.0, "do not use")])
def test_lengths_of_another_person_concern_all_that_is_shown(powers, word):
    lengths_of = persons.person_finding(LengthEvidence(powers, (LengthChange("thigh", 38.4, 9.0),)))
    found = list(check_reasons(Evidence(checks=(lengths_of,), unshown=("left_arm",))))
    assert {one.part for one in found} == (set() if word == "use" else set(MOTION_PARTS) - {"left_arm"})
    assert gravest(one.word for one in found) == word
    assert all("thigh 38 ± 9 mm longer" in one.found for one in found)
    assert all(one.weight > 8.0 for one in found), "the cause of other findings stands before them"


def test_a_second_person_calls_for_a_look_at_all_that_is_shown():
    hint = f"41 markers that are not the subject's lie up to 1.5 m from it{in_view.REMEDY}"
    second = Finding(in_view.NAME, 41.0, 2.5, "markers", 5.0, "outside", hint)
    found = list(check_reasons(Evidence(checks=(second,), unshown=("left_arm",))))
    assert {one.part for one in found} == set(MOTION_PARTS) - {"left_arm"}
    assert {one.word for one in found} == {"look"} and found[0].found.endswith("1.5 m from it")
    assert found[0].do.startswith("make sure")
