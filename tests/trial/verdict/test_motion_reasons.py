"""Reasons against motions: each bound from both sides, and the parts that are meant."""

from dataclasses import replace

import pytest

from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.verdict import MOTION_PARTS, gravest
from mbkf.trial.verdict.evidence import Evidence
from mbkf.trial.verdict.fit import PartFit
from mbkf.trial.verdict.holes import Hole
from mbkf.trial.verdict.motion_reasons import FIT, INNOVATION, RANGE_DEG, Bounds, motion_reasons
from mbkf.trial.verdict.ranges import Beyond
from mbkf.trial.verdict.standing import Stood

LEG = PartFit("left_leg", 8, 5.0, 0.5, 1.0, 0.0, "LANK")


def word_on(part, **evidence):
    return gravest(one.word for one in motion_reasons(Evidence(**evidence)) if one.part == part)


def test_no_evidence_against_a_trial_gives_no_reason():
    assert list(motion_reasons(Evidence(fits=(LEG,)))) == []


@pytest.mark.parametrize(
    ("size", "word"), [(0.99, "use"), (1.0, "look"), (1.99, "look"), (2.0, "do not use")]
)
def test_words_begin_at_their_bounds(size, word):
    assert word_on("left_leg", fits=(replace(LEG, per_noise=_scaled(FIT, size)),)) == word
    assert word_on("left_leg", fits=(replace(LEG, nis=_scaled(INNOVATION, size)),)) == word
    knee = Beyond("left_leg", "left_shank", _scaled(RANGE_DEG, size), 0.5)
    assert word_on("left_leg", beyond=(knee,)) == word
    assert word_on("right_leg", beyond=(knee,)) == "use"


def _scaled(bounds: Bounds, size: float) -> float:
    """A number whose word changes at 1 and at 2."""
    return bounds.look * size if size < 1.0 else bounds.look + (size - 1.0) * (bounds.leave - bounds.look)


def test_the_text_names_number_unit_part_and_marker():
    (found,) = motion_reasons(Evidence(fits=(replace(LEG, per_noise=3.0, rms_mm=31.0),)))
    assert found.found == (
        "markers of the left leg lie 31 mm from the body, 3.0 times as far as their noise explains; worst is LANK"
    )
    assert found.word == "do not use" and found.weight == pytest.approx(3.0 / FIT.leave)


def test_a_part_that_is_not_shown_says_so():
    (found,) = motion_reasons(Evidence(unshown=("left_arm",)))
    assert (found.part, found.word, found.shown) == ("left_arm", "do not use", False)


def test_an_unmarked_pelvis_is_named_with_its_spreads_on_all_parts_beside_it():
    hole = Hole(
        "pelvis",
        ("pelvis", "trunk", "right_leg", "left_leg"),
        {"pelvis_tilt": 6.2, "hip_flexion": 6.8},
        ("right_asis", "left_asis", "right_psis", "left_psis"),
    )
    found = list(motion_reasons(Evidence(unshown=("pelvis", "left_leg"), holes=(hole,))))
    words = {one.part: one.word for one in found}
    assert words == {"pelvis": "do not use", "left_leg": "do not use", "right_leg": "look", "trunk": "look"}
    of_hole = [one for one in found if one.part != "left_leg"]
    assert {one.found for one in of_hole} == {
        "the pelvis has no markers; uncertain (1 sd) are pelvis tilt by 6°, hip flexion by 7°"
    }
    assert all("put markers on it (right asis, left asis, right psis)" in one.do for one in of_hole)


def test_a_segment_that_is_not_shown_makes_its_part_doubtful():
    assert word_on("right_leg", unshown_segments={"right_leg": ("right_foot",)}) == "look"


@pytest.mark.parametrize(
    ("part", "sd", "word"),
    [
        ("left_leg", 9.0, "use"),
        ("left_leg", 12.0, "look"),
        ("left_leg", 25.0, "do not use"),
        ("left_arm", 15.0, "use"),
        ("left_arm", 45.0, "do not use"),
    ],
)
def test_wide_spreads_have_words(part, sd, word):
    assert word_on(part, spread_deg={part: sd}) == word


@pytest.mark.parametrize(
    ("evidence", "word"),
    [
        ({"tracked": 0.97}, "use"),
        ({"tracked": 0.9}, "look"),
        ({"tracked": 0.4}, "do not use"),
        ({"explained": 0.7}, "use"),
        ({"explained": 0.5}, "look"),
        ({"explained": 0.2}, "do not use"),
        ({"doubts": ("the fit did not converge",)}, "look"),
    ],
)
def test_what_concerns_the_whole_trial_concerns_every_shown_part(evidence, word):
    assert {word_on(part, **evidence) for part in MOTION_PARTS} == {word}
    assert word_on("trunk", **evidence, unshown=("trunk",)) == "do not use"


def test_refused_samples_have_words():
    assert word_on("left_leg", fits=(replace(LEG, refused=0.15),)) == "look"


@pytest.mark.parametrize(
    ("share", "mended", "word"),
    [(0.02, False, "use"), (0.1, False, "look"), (0.5, False, "do not use"), (0.5, True, "look")],
)
def test_a_limb_in_doubt_counts_by_its_share_of_the_trial(share, mended, word):
    doubt = LimbDoubt("left_thigh", "turned over", 0.0, 1.0, misfit_m=0.03, mended=mended)
    evidence = {"doubtful_limbs": ((doubt, share),), "part_of": {"left_thigh": "left_leg"}}
    assert word_on("left_leg", **evidence) == word


@pytest.mark.parametrize(("degrees", "word"), [(-21.0, "use"), (-42.0, "look"), (93.0, "do not use")])
def test_a_static_in_which_no_one_stands_so_has_its_word(degrees, word):
    stood = (Stood("left_leg", "left_foot", degrees), Stood("left_leg", "left_shank", 16.0))
    assert word_on("left_leg", stood=stood) == word and word_on("right_leg", stood=stood) == "use"
    assert len(list(motion_reasons(Evidence(stood=stood)))) == (word != "use"), "one reason for a leg"


def test_names_of_the_static_that_scaling_put_right_ask_for_a_look_at_their_parts():
    pairs = (("RKNE", "LKNE", ("right_leg", "left_leg")), ("RANK", "RHEE", ("right_leg",)))
    assert [word_on(part, static_exchanges=pairs) for part in ("right_leg", "left_leg", "pelvis")] == [
        "look", "look", "use",
    ]  # fmt: skip
    right, left = motion_reasons(Evidence(static_exchanges=pairs))
    assert "RKNE and LKNE, RANK and RHEE" in right.found and "--keep-names" in right.do
    assert "RANK" not in left.found
