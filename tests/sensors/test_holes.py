"""Joints beside a segment without markers: those on both sides of it, where segments beyond it carry some."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.holes import beside_holes
from mbkf.sensors.marker_sensor import MarkerSensor

MODEL = HumanModel.scaled()
MARKERS = [one for one in load_protocol("reference36").markers if one.kind != "computed"]


def joints_beside(*unmarked: str) -> set[str]:
    """Segments whose joints are beside holes where some segments carry no marker."""
    own = [one for one in MARKERS if one.segment not in unmarked]
    sensor = MarkerSensor(MODEL, [one.segment for one in own], np.array([one.position_m for one in own]))
    found = beside_holes(sensor, ~MODEL.supports[sensor.joint_ids].any(axis=0))
    for joint in MODEL.joints.values():
        assert found[joint.v].all() == found[joint.v].any()
    return {name for name, joint in MODEL.joints.items() if found[joint.v].any()}


@pytest.mark.parametrize(
    ("unmarked", "beside"),
    [
        ((), set()),
        (("pelvis",), {"torso", "right_thigh", "left_thigh"}),
        (("right_thigh",), {"right_thigh", "right_shank"}),
        (("left_shank",), {"left_shank", "left_foot"}),
        (("right_hand",), set()),
        (("right_foot", "right_toes"), set()),
        (("right_thigh", "right_shank"), {"right_thigh", "right_shank", "right_foot"}),
    ],
)
def test_joints_on_both_sides_of_an_unmarked_segment_but_not_of_an_end_or_the_neck(unmarked, beside):
    assert joints_beside(*unmarked) == beside
