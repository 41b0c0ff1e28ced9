"""Joints of OpenSim's models in the forms of version 3 and 4, and reasons why one cannot be followed."""

import re

import numpy as np
import pytest

from mbkf.io.loose_xml import parse_loose_xml
from mbkf.io.osim_joints import osim_joints
from tests.osim_mechanisms import LINE, joint, spatial_transform

OLD = (
    '<Body name="shin"><Joint><CustomJoint name="knee"><parent_body>thigh</parent_body>'
    "<location_in_parent>0 -0.4 0</location_in_parent><orientation_in_parent>0 0 0</orientation_in_parent>"
    "<location>0 0.1 0</location><orientation>0 0 0</orientation><CoordinateSet><objects>"
    '<Coordinate name="bend"><default_value>0.2</default_value><range>0 2</range><clamped>true</clamped>'
    "<locked>true</locked></Coordinate></objects></CoordinateSet>{transform}</CustomJoint></Joint></Body>"
)


def read(text):
    return list(osim_joints(parse_loose_xml(text), {}))


def test_a_joint_of_version_3():
    (knee,) = read(OLD.format(transform=spatial_transform((("bend", LINE),), ())))
    assert (knee.parent, knee.child, knee.name, knee.fault) == ("thigh", "shin", "knee", "")
    assert knee.child_in_parent[:3, 3] == pytest.approx([0.0, -0.5, 0.0])
    assert knee.centre_m == pytest.approx([0.0, 0.1, 0.0])
    (bend,) = knee.coordinates
    assert (bend.default, bend.lowest, bend.highest) == (0.2, 0.0, 2.0)
    assert bend.clamped and bend.locked and bend.rotational and not bend.prescribed
    (turn,) = knee.turns
    assert turn.direction == pytest.approx([1.0, 0.0, 0.0]) and turn.amount.line == (0.0, 1.0)


def test_a_coordinate_without_a_function_moves_its_axis_and_an_axis_of_any_length_turns():
    text = spatial_transform((("bend", ""),), ()).replace("1 0 0", "3 0 0")
    (knee,) = read(OLD.format(transform=text))
    (turn,) = knee.turns
    assert turn.amount.line == (0.0, 1.0)
    assert turn.direction == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (joint("PinJoint", "a", "b", ()), "0 of 1 coordinates"),
        (joint("PinJoint", "a", "b", ("x",), "<reverse>true</reverse>"), "reversed"),
        (joint("ScapulothoracicJoint", "a", "b", ("x",)), "ScapulothoracicJoint"),
        (joint("CustomJoint", "a", "b", ("x",), spatial_transform((("x", "<Sine/>"),), ())), "rotation1.*Sine"),
        (
            joint("CustomJoint", "a", "b", ("x",), spatial_transform((("x", LINE),), ()).replace("1 0 0", "0 0 0")),
            "no axis",
        ),
    ],
)  # fmt: skip
def test_reasons_why_a_joint_cannot_be_followed(text, fault):
    (found,) = read(f"<Model><JointSet><objects>{text}</objects></JointSet></Model>")
    assert found.fault and np.all(np.isfinite(found.child_in_parent))
    assert re.search(fault, found.fault)
