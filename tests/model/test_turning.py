"""Errors turn with the root and with spherical joints, and not with hinges."""

import numpy as np
import pinocchio as pin

from mbkf.model.turning import Turning
from tests.motions import reference_model


def test_blocks_are_those_of_the_joints():
    model = reference_model()
    v = np.random.default_rng(1).normal(size=model.nv)
    expected = np.zeros((model.nv, model.nv))
    expected[:3, :3] = expected[3:6, 3:6] = -pin.skew(v[3:6])
    expected[:3, 3:6] = -pin.skew(v[:3])
    for joint in model.joints.values():
        if joint.kind == "spherical":
            expected[joint.v, joint.v] = -pin.skew(v[joint.v])
    found = Turning.of(model).at(v)
    np.testing.assert_array_equal(found, expected)
    hinges = [joint.v for joint in model.joints.values() if joint.kind not in ("spherical", "free")]
    assert hinges and not any(found[dofs].any() for dofs in hinges)
