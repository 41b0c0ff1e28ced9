"""Joint origins against where Pinocchio puts the joints."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.model.human import HumanModel
from mbkf.model.skeleton import joint_origin


def test_origins_add_up_to_the_neutral_posture():
    model = HumanModel.scaled({"trunk_height": 1.1, "right_thigh": 0.9}, 70.0)
    _, p = model.placements(model.neutral())
    for segment in model.description.segments:
        below = np.zeros(3) if segment.parent == "world" else p[model.joint(segment.parent).joint_id]
        np.testing.assert_allclose(
            p[model.joint(segment.name).joint_id] - below, joint_origin(model, segment.name)
        )
    with pytest.raises(UnknownName):
        joint_origin(model, "tail")
