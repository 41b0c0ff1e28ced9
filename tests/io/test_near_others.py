"""Stretches in which another person is near."""

import numpy as np
import pytest

from mbkf.io.near_others import near_markers, near_remarks
from mbkf.io.records import MarkerTrajectories


def test_a_hand_that_rests_on_a_knee_for_a_while():
    own, other = np.zeros((100, 2, 3)), np.full((100, 2, 3), np.nan)
    own[:, 1, 0] = 1.0
    other[:, 0] = [1.0, 0.5, 0.0]
    other[30:61, 0, 1] = 0.04
    other[80:85, 0, 1] = 0.04
    found = near_markers(
        MarkerTrajectories(("C7", "KNE"), own, 100.0, 2.0), MarkerTrajectories(("W", "X"), other, 100.0, 2.0)
    )
    assert [(one.part, one.from_s, one.to_s) for one in found] == [("KNE", 2.3, 2.6)]
    assert found[0].nearest_m == pytest.approx(0.04)
    (remark,) = near_remarks(found)
    assert "40 mm of KNE from 2.30 to 2.60 s: a possible contact" in remark
    assert near_remarks([*found] * 5, most=2)[2] == "and 3 more possible contacts"
