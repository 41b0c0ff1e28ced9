"""Parts of the body: every segment belongs to one, and ends of limbs are not needed for a part's motion."""

from mbkf.io.verdict import MOTION_PARTS
from mbkf.model.body_file import load_body
from mbkf.trial.verdict.parts import main_segments, markers_of_part, part_of_segment


def test_every_segment_has_its_part():
    body = load_body("human18")
    part = part_of_segment(body)
    assert set(part) == {one.name for one in body.segments}
    assert (part["pelvis"], part["head"], part["torso"]) == ("pelvis", "trunk", "trunk")
    assert (part["left_toes"], part["right_hand"]) == ("left_leg", "right_arm")


def test_ends_of_limbs_are_not_needed():
    main = main_segments(load_body("human18"))
    assert set(main) == set(MOTION_PARTS)
    assert main["right_leg"] == ("right_thigh", "right_shank", "right_foot")
    assert main["left_arm"] == ("left_upper_arm", "left_forearm")
    assert main["trunk"] == ("torso",) and main["pelvis"] == ("pelvis",)


def test_markers_go_with_their_segments():
    found = markers_of_part(load_body("human18"), ["torso", "left_foot", "pelvis", "left_thigh"])
    assert (found["left_leg"], found["trunk"], found["right_arm"]) == ([1, 3], [0], [])
