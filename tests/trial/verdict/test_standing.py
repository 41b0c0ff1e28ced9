"""Joints of the legs as a person stood: upright ones are not listed, bent ones by their degrees."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.subject import STANDING_KEY
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.verdict.standing import stood_bent

PERSON = synthesise_subject(3)
MODEL = body_of(PERSON)


def standing(**degrees):
    """The person with a static trial in which joints are turned about y."""
    turn = np.zeros(MODEL.nv)
    for joint, angle in degrees.items():
        turn[MODEL.joints[joint].v.start + 1] = np.deg2rad(angle)
    q = MODEL.integrate(MODEL.neutral(), turn)
    return replace(PERSON, report={**PERSON.report, STANDING_KEY: [float(x) for x in q]})


def test_an_upright_person_has_no_bent_joint():
    assert stood_bent(MODEL, standing(left_shank=10.0)) == ()
    assert stood_bent(MODEL, replace(PERSON, report={})) == ()


def test_bent_joints_of_legs_stand_by_their_size():
    knee, ankle = stood_bent(MODEL, standing(left_shank=60.0, right_foot=-42.0))
    assert (knee.part, knee.segment, ankle.part) == ("left_leg", "left_shank", "right_leg")
    assert knee.degrees == pytest.approx(60.0) and ankle.degrees == pytest.approx(-42.0)


def test_arms_may_be_raised():
    assert stood_bent(MODEL, standing(left_upper_arm=90.0)) == ()
