"""Hip centres against functional ones at known places."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.real_truth.hips import METHODS, hip_distances
from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel
from tests.walker import walker

AWAY_M = np.array([0.003, 0.004, 0.0])


def test_distances_are_those_from_the_mean_of_the_methods():
    subject = walker().subject
    model = HumanModel.of(subject)
    q = np.array([model.neutral()] * 2)
    hip = model.placements(q[0])[1][model.joint("right_thigh").joint_id]
    places = hip + AWAY_M + np.array([[0.009, 0.0, 0.0], [-0.009, 0.0, 0.0], [0.0, 0.0, 0.0]])
    names = tuple(f"RightHipCenter{method}" for method in METHODS)
    capture = SimpleNamespace(markers=MarkerTrajectories(names, np.array([places, places]), 100.0))
    found = hip_distances(capture, SimpleNamespace(subject=subject, q=q))
    assert found == {"r": (pytest.approx(5.0), pytest.approx(6.0))}
