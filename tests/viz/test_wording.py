"""Every clinical coordinate has a readable title, and both sides are told apart."""

import numpy as np

from mbkf.model.body_file import load_body
from mbkf.viz.wording import part_wording, wordings


def test_every_coordinate_has_its_own_title():
    names = [c.name for joint in load_body().clinical_joints for c in joint.coordinates]
    found = wordings(load_body().clinical_joints)
    assert sorted(found) == sorted(names)
    titles = [w.full_title for w in found.values()]
    assert len(set(titles)) == len(titles)
    assert not [title for title in titles if "_" in title or not title[0].isupper()]


def test_every_part_that_may_bear_load_has_a_title():
    found = [part_wording(name) for name in ("right_foot", "left_foot", *load_body().bearings)]
    assert {one.full_title for one in found} >= {"Right foot", "Left hand", "Pelvis", "Torso", "Right knee"}
    assert len({one.full_title for one in found}) == len(found)
    assert {one.side for one in found} == {"r", "l", ""}


def test_sides_units_and_joints():
    w = wordings(load_body().clinical_joints)
    knee = w["knee_angle_l"]
    assert (knee.full_title, knee.joint, knee.side) == ("Knee flexion, left", "knee", "l")
    assert (knee.unit, knee.load_unit) == ("°", "N m")
    assert knee.factor * np.pi == 180.0
    height = w["pelvis_ty"]
    assert (height.full_title, height.unit, height.factor, height.load_unit) == (
        "Pelvis height",
        "m",
        1.0,
        "N",
    )
    assert w["lumbar_extension"].side == ""
