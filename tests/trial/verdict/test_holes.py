"""Holes of a trial: the unmarked segment, the joints beside it with the larger spread of both sides, landmarks."""

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.trial.verdict.holes import holes
from mbkf.trial.verdict.parts import part_of_segment

MODEL = HumanModel.scaled()
EVERYTHING = frozenset(MODEL.joints)
NOTHING = np.zeros(MODEL.nv, dtype=bool)


def found(*unmarked, unobservable=NOTHING):
    mean_sd = {"pelvis_tilt": 0.1, "hip_flexion_r": 0.1, "hip_flexion_l": 0.2, "knee_angle_r": 0.05}
    parts = part_of_segment(MODEL.description)
    return holes(MODEL, EVERYTHING - set(unmarked), unobservable, parts, mean_sd)


def test_a_pelvis_concerns_trunk_and_both_legs():
    (hole,) = found("pelvis")
    assert hole.parts == ("pelvis", "trunk", "right_leg", "left_leg")
    assert {name: round(sd) for name, sd in hole.spread_deg.items()} == {"pelvis_tilt": 6, "hip_flexion": 11}
    assert hole.landmarks[:2] == ("right_asis", "left_asis")


def test_a_thigh_concerns_its_leg():
    (hole,) = found("right_thigh")
    assert hole.parts == ("right_leg",) and list(hole.spread_deg) == ["hip_flexion", "knee_angle"]
    assert hole.found.startswith("the right thigh has no markers; uncertain (1 sd) are hip flexion by 6°")


def test_what_moves_no_marker_and_the_neck_are_no_holes():
    held = NOTHING.copy()
    held[MODEL.joint("right_hand").v] = True
    assert found() == found("neck") == found("right_hand", unobservable=held) == ()
