"""Frames of a motion are those of its configurations; frames that are not followed stay unknown."""

import numpy as np
import pytest

from mbkf.model.motion_frames import motion_frames
from tests.motions import assert_near, moderate_pose, random_model


@pytest.mark.parametrize("compiled", [True, False])
def test_frames_of_a_motion_are_those_of_its_configurations(compiled, monkeypatch):
    rng = np.random.default_rng(4)
    model = random_model(rng)
    q = np.array([moderate_pose(model, rng) for _ in range(3)])
    q[1, 9] = np.nan
    if not compiled:
        monkeypatch.setattr(type(model), "tree", None)
    frames, jacobians = motion_frames(model, q)
    assert np.isnan(frames[1]).all() and np.isnan(jacobians[1]).all()
    for t in (0, 2):
        rotations, origins, jacobian = model.placements_and_jacobian(q[t])
        assert_near(frames[t, :, :3].swapaxes(1, 2), rotations, 1e-12)
        assert_near(frames[t, :, 3], origins, 1e-12)
        assert_near(jacobians[t], jacobian, 1e-12)
