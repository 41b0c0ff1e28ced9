"""Configurations from orientations of segments: those of a known posture come back."""

import numpy as np
import pytest

from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.segment_course import configurations
from mbkf.model.human import HumanModel
from tests.oblique_hinges import oblique_body

MODELS = (HumanModel.scaled(), HumanModel.scaled(body=oblique_body()))


LEG = ("right_thigh", "right_shank", "right_foot")


@pytest.mark.parametrize(
    "segments",
    [("pelvis", "torso", *LEG), LEG, (*LEG, "right_toes", "left_thigh"), ("torso", *LEG)],
    ids=" ".join,
)
@pytest.mark.parametrize("model", MODELS, ids=("straight", "oblique"))
def test_a_posture_comes_back_from_the_turns_of_its_segments(segments, model):
    rng = np.random.default_rng(4)
    q = model.neutral()
    for name in ("pelvis", *segments[1:]):
        joint = model.joint(name)
        step = np.zeros(model.nv)
        step[joint.v] = 0.4 * rng.normal(size=joint.v.stop - joint.v.start)
        q = model.integrate(q, step)
    rotations, _ = model.placements(q)
    course = matrix_quaternion(np.array([rotations[model.joint(name).joint_id] for name in segments]))
    found = configurations(model, segments, course[None])[0]
    np.testing.assert_allclose(model.difference(q, found)[3:], 0.0, atol=1e-9)
