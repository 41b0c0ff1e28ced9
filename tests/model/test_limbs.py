"""Limbs of a body: chains with a side, from where they hang on the trunk."""

import numpy as np

from mbkf.model.limbs import limbs
from tests.motions import reference_model

MODEL = reference_model()


def test_legs_and_arms_with_all_that_moves_with_them():
    found = {one.name: one for one in limbs(MODEL)}
    assert set(found) == {"right_thigh", "left_thigh", "right_upper_arm", "left_upper_arm"}
    leg = found["left_thigh"]
    assert [one.segment for one in leg.joints] == ["left_thigh", "left_shank", "left_foot", "left_toes"]
    moved = {name for name, one in MODEL.joints.items() if MODEL.supports[one.joint_id, leg.dofs].any()}
    assert moved == {one.segment for one in leg.joints}
    assert leg.other_side == "right_thigh"


def test_no_dof_belongs_to_two_limbs():
    every = np.concatenate([one.dofs for one in limbs(MODEL)])
    assert len(np.unique(every)) == len(every)
