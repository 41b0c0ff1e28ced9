"""One walk, one deep flexion and one movement of the arms are chosen, whatever the order of the trials."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.io.session import TrialKind
from mbkf.study.scaling.choice import Part, choose
from mbkf.study.scaling.excitation import Excitation

STILL = Excitation(TrialKind.STATIC, 2.0, 2.0, 2.0, {"torso": 3.0, "right_upper_arm": 3.0}, 1.0)
WALK = replace(STILL, kind=TrialKind.WALK, hips_deg=25.0, knees_deg=35.0, swing_deg=60.0)
RUN = replace(WALK, kind=TrialKind.RUN, swing_deg=100.0)
SQUAT = replace(STILL, kind=TrialKind.SQUAT, hips_deg=105.0, knees_deg=100.0, swing_deg=100.0)
JUMP = replace(SQUAT, kind=TrialKind.JUMP)
REACH = replace(STILL, kind=TrialKind.UNKNOWN, upper_deg={"torso": 20.0, "right_upper_arm": 120.0})
KINDS = {"still": STILL, "walk": WALK, "run": RUN, "squat": SQUAT, "jump": JUMP, "reach": REACH}


def parts(**trials):
    return {one.name: one.part for one in choose(trials).chosen}


def test_each_movement_has_one_trial_and_every_other_one_its_reason():
    stairs = replace(SQUAT, kind=TrialKind.UNKNOWN, hips_deg=45.0, knees_deg=60.0)
    found = choose({**KINDS, "walk2": WALK, "squat2": SQUAT, "stairs": stairs}, {"film": "it cannot be read"})
    assert [(one.name, one.part) for one in found.chosen] == [
        ("walk", Part.WALK), ("squat", Part.DEEP), ("reach", Part.UPPER),
    ]  # fmt: skip
    assert found.left_out == {
        "film": "it cannot be read",
        "jump": "impacts shake its markers, and calm trials show as much",
        "run": "impacts shake its markers, and calm trials show as much",
        "squat2": "another trial bends as deeply",
        "stairs": "hips bend to 45° and knees to 60°; deep flexion takes 70° and 80°",
        "still": "the person stands still",
        "walk2": "another walk shows as much",
    }
    assert [one.why for one in found.chosen] == [
        "both legs step, knees bend to 60°", "hips bend to 105°, knees to 100°", "right upper arm turns by 120°",
    ]  # fmt: skip
    assert found.complete and found.names == ("walk", "squat", "reach")


def test_impacts_are_taken_only_where_nothing_calm_shows_the_movement():
    assert parts(run=RUN, squat=SQUAT) == {"run": Part.WALK, "squat": Part.DEEP}
    assert parts(jump=JUMP, walk=WALK) == {"jump": Part.DEEP, "walk": Part.WALK}
    found = choose({"run": RUN, "jump": JUMP})
    assert not found.complete and all(one.why.endswith("with impacts") for one in found.chosen)


def test_half_a_squat_stillness_and_a_walk_with_lifted_arms_are_not_enough():
    half = replace(SQUAT, hips_deg=60.0)
    assert parts(half=half, still=STILL) == {}
    assert parts(high=replace(WALK, upper_deg=REACH.upper_deg)) == {"high": Part.WALK}


def test_arms_count_by_what_they_add():
    lifted = replace(SQUAT, upper_deg={"right_upper_arm": 110.0})
    assert parts(squat=lifted, reach=REACH) == {"squat": Part.DEEP}
    assert parts(squat=SQUAT, reach=REACH) == {"squat": Part.DEEP, "reach": Part.UPPER}
    assert parts(chair=SQUAT, squat=replace(lifted, coverage=0.95)) == {"squat": Part.DEEP}


@pytest.mark.parametrize("better", [{"coverage": 1.0}, {"hips_deg": 100.0, "knees_deg": 105.0}])
def test_the_trial_that_shows_more_is_taken_whatever_its_name(better):
    """The worse one has larger gaps, or bends less deeply."""
    poor = replace(SQUAT, coverage=0.8, hips_deg=75.0, knees_deg=82.0)
    assert parts(a=poor, b=replace(poor, **better)) == {"b": Part.DEEP}


@given(st.lists(st.sampled_from(sorted(KINDS)), max_size=9), st.randoms())
def test_the_order_of_the_trials_does_not_matter(kinds, chance):
    trials = [(f"{kind}{k}", KINDS[kind]) for k, kind in enumerate(kinds)]
    shuffled = trials.copy()
    chance.shuffle(shuffled)
    found = choose(dict(shuffled))
    assert found == choose(dict(trials)) and list(found.left_out) == sorted(found.left_out)
    assert {*found.names, *found.left_out} == {name for name, _ in trials}
    assert len({one.part for one in found.chosen}) == len(found.chosen)
