"""A person followed beside a reference, from the capture to the differences."""

import numpy as np
import pytest

from benchmarks.real_truth.followed import STATIC, Job, followed
from benchmarks.real_truth.persons import PERSONS

pytestmark = pytest.mark.slow


def test_a_child_s_standing_and_walk_agree_with_plug_in_gait(real_data):
    (child,) = [one for one in PERSONS if one.name == "HC044A"]
    standing, walk = followed(Job(real_data, child, STATIC))
    assert (standing.trial, walk.trial) == ("standing", "walk")
    assert {one.name for one in walk.angles} == {
        f"{name}_{side}" for name in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl"
    }
    assert standing.moments == ()
    assert max(abs(one.offset) for one in walk.angles) < 3.0
    assert min(walk.r.values()) > 0.85
    assert walk.marker_rms_mm == pytest.approx(3.0, abs=0.5)
    assert np.isnan(walk.residual_n[1])
