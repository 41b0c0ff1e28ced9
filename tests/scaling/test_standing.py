"""Upright standing: no residual in neutral posture, inclinations where there are any, derivatives."""

import numpy as np
import pytest

from mbkf.scaling.standing import FLAT_SD_RAD, UPRIGHT_SD_RAD, UprightPosture
from tests.motions import assert_near, central_difference, moderate_pose, reference_model

MODEL = reference_model()
STANDING = UprightPosture(MODEL)


def test_a_person_in_neutral_posture_stands():
    np.testing.assert_allclose(STANDING.residuals(MODEL, MODEL.neutral()), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("joint", "rows", "sd"),
    [
        ("right_foot", [0, 1], FLAT_SD_RAD),
        ("left_foot", [2, 3], FLAT_SD_RAD),
        ("torso", [6, 7], UPRIGHT_SD_RAD),
    ],
)
def test_a_segment_that_leans_is_told_by_its_angle(joint, rows, sd):
    step = np.zeros(MODEL.nv)
    step[MODEL.joint(joint).v][1] = 0.2
    found = STANDING.residuals(MODEL, MODEL.integrate(MODEL.neutral(), step))
    assert np.linalg.norm(found[rows]) == pytest.approx(np.sin(0.2) / sd)
    np.testing.assert_allclose(np.delete(found, rows), 0.0, atol=1e-12)


def test_spreads_of_some_segments_alone():
    level = UprightPosture(MODEL, {"right_foot": 0.1})
    step = np.zeros(MODEL.nv)
    step[MODEL.joint("right_foot").v][1] = step[MODEL.joint("torso").v][1] = 0.2
    found = level.residuals(MODEL, MODEL.integrate(MODEL.neutral(), step))
    assert np.linalg.norm(found) == pytest.approx(np.sin(0.2) / 0.1)
    assert UprightPosture(MODEL, {}).residuals(MODEL, MODEL.neutral()).size == 0


def test_derivatives():
    q = moderate_pose(MODEL, np.random.default_rng(8))
    found, jacobian = STANDING.linearised(MODEL, q)
    np.testing.assert_allclose(found, STANDING.residuals(MODEL, q))
    assert_near(jacobian, central_difference(MODEL, lambda x: STANDING.residuals(MODEL, x), q), 1e-6)
