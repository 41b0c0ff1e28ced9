"""Sensor names in the words of several programs."""

import pytest

from mbkf.errors import UnknownName
from mbkf.imu.segments import segment_of
from mbkf.model.human import HumanModel

SEGMENTS = tuple(HumanModel.scaled().joints)


@pytest.mark.parametrize(
    ("name", "segment"),
    [
        ("right_thigh", "right_thigh"), ("femur_r", "right_thigh"), ("femur_r_imu", "right_thigh"),
        ("calcn_l", "left_foot"), ("upper_leg_left", "left_thigh"), ("LeftFoot", "left_foot"), ("hip", "pelvis"),
        ("Sternum", "torso"), ("lower_leg_right", "right_shank"), ("upper_arm_left", "left_upper_arm"),
    ],
)  # fmt: skip
def test_names_are_understood(name, segment):
    assert segment_of(name, SEGMENTS) == segment


@pytest.mark.parametrize("name", ["thigh", "left_sensor", "tail", ""])
def test_others_are_refused(name):
    with pytest.raises(UnknownName):
        segment_of(name, SEGMENTS)
