"""Displacements of joint centres: mirrored sides that are alike, and joints that move as stated."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import OWN_SHARE, centre_covariance, centre_levers, centre_names
from mbkf.model.scale_derivatives import OriginLevers
from tests.motions import moderate_pose, reference_model

BODY = reference_model().description
NAMES = centre_names(BODY)


def test_sides_mirror_each_other_for_the_most_part():
    covariance = centre_covariance(BODY)
    assert np.linalg.eigvalsh(covariance).min() > 0.0
    sd = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(sd, sd)
    for axis, sign in (("x", 1.0), ("y", -1.0), ("z", 1.0)):
        right, left = (NAMES.index(f"{side}_thigh_centre_{axis}") for side in ("right", "left"))
        assert correlation[right, left] == pytest.approx(sign * (1.0 - OWN_SHARE**2))
        assert sd[right] == pytest.approx(1e-3 * {"x": 8.0, "y": 6.0, "z": 8.0}[axis])
    shoulder = [NAMES.index(f"right_upper_arm_centre_{axis}") for axis in "xyz"]
    np.testing.assert_allclose(sd[shoulder], [0.008, 0.012, 0.015])
    middle = NAMES.index("torso_centre_z")
    assert np.count_nonzero(covariance[middle]) == 1


def test_joints_move_by_their_levers():
    rng = np.random.default_rng(1)
    q = moderate_pose(reference_model(), rng)
    displaced = 0.01 * rng.normal(size=len(NAMES))
    rotations, before = reference_model().placements(q)
    body = HumanModel(BODY, np.ones(len(BODY.scale_factors)), BODY.reference_mass_kg, centres_m=displaced)
    _, after = body.placements(q)
    origins = OriginLevers(reference_model())
    moved = origins.summed(rotations, origins.centre_levers @ displaced[:, None])[..., 0]
    own = [joint.joint_id for joint in body.joints.values()]
    np.testing.assert_allclose((after - before)[own], moved[own], atol=1e-12)
    segments = [segment.name for segment in BODY.segments if segment.parent != "world"]
    levers = centre_levers(reference_model(), segments)
    np.testing.assert_array_equal(levers, origins.centre_levers)
    assert np.abs(moved).max() > 0.01
