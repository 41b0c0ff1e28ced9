"""Configurations from orientations of segments: those of a known posture come back."""

import numpy as np
import pytest

from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.segment_course import configurations
from mbkf.model.human import HumanModel

MODEL = HumanModel.scaled()


LEG = ("right_thigh", "right_shank", "right_foot")


@pytest.mark.parametrize(
    "segments", [("pelvis", "torso", *LEG), LEG, (*LEG, "left_thigh"), ("torso", *LEG)], ids=" ".join
)
def test_a_posture_comes_back_from_the_turns_of_its_segments(segments):
    rng = np.random.default_rng(4)
    q = MODEL.neutral()
    for name in ("pelvis", *segments[1:]):
        joint = MODEL.joint(name)
        step = np.zeros(MODEL.nv)
        step[joint.v] = 0.4 * rng.normal(size=joint.v.stop - joint.v.start)
        q = MODEL.integrate(q, step)
    rotations, _ = MODEL.placements(q)
    course = matrix_quaternion(np.array([rotations[MODEL.joint(name).joint_id] for name in segments]))
    found = configurations(MODEL, segments, course[None])[0]
    np.testing.assert_allclose(MODEL.difference(q, found)[3:], 0.0, atol=1e-9)
