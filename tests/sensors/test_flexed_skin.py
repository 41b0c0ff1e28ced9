"""Skin that moves by flexion: zero in the neutral posture, its stated share at 60°, and derivatives by differences."""

import numpy as np
import pytest

from mbkf.sensors.flexed_skin import FLEXED_RAD, FlexedSkin, flexions_of, slide_covariance
from mbkf.sensors.posture_sensor import PostureSensor
from tests.motions import assert_near, central_difference, moderate_pose, reference_model

MODEL = reference_model()
SEGMENTS = ["right_thigh", "head", "left_thigh", "torso", "left_thigh", ""]
SKIN = FlexedSkin(MODEL, SEGMENTS)


def flexed(segment, angle_rad):
    """The neutral posture with one joint turned about y."""
    turned, dofs = np.zeros(MODEL.nv), MODEL.joint(segment).v
    turned[dofs.start + (dofs.stop - dofs.start > 1)] = angle_rad
    return MODEL.integrate(MODEL.neutral(), turned)


def test_neutral_skin_is_where_it_was():
    assert SKIN.shares(MODEL.neutral()).shape == (len(SEGMENTS), SKIN.flexions)
    np.testing.assert_allclose(SKIN.shares(MODEL.neutral()), 0.0, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("joint", "marker", "flexion", "share"),
    [
        ("right_thigh", 0, 0, 1.0),
        ("right_shank", 0, 1, 1.0),
        ("left_thigh", 4, 0, 1.0),
        ("torso", 3, 0, 1.0),
        # of two arms their mean counts: sin 15° / sin 30°
        ("left_upper_arm", 3, 1, np.sin(np.pi / 12) / np.sin(np.pi / 6)),
    ],
)
def test_a_joint_at_60_degrees_moves_its_neighbours_markers_alone(joint, marker, flexion, share, sign):
    found = SKIN.shares(flexed(joint, sign * FLEXED_RAD))
    assert found[marker, flexion] == pytest.approx(sign * share, abs=1e-9)
    moved = {own for own, shares in zip(SEGMENTS, found, strict=True) if np.abs(shares).max() > 1e-9}
    assert moved == {SEGMENTS[marker]}


def test_derivatives_are_those_of_the_displacements():
    """Of several poses at once, added to what is there."""
    rng, posture = np.random.default_rng(1), PostureSensor(MODEL)
    poses = [moderate_pose(MODEL, rng) for _ in range(3)]
    moved = rng.normal(0.0, 0.01, (3, len(SEGMENTS), 3, SKIN.flexions))
    before = rng.normal(size=(3, len(SEGMENTS), 3, MODEL.nv))
    found = before.copy()
    deviations, jacobians = zip(*(posture.deviation(q) for q in poses), strict=True)
    SKIN.add_by_poses(found, moved, np.array(deviations), jacobians)
    for n, q in enumerate(poses):
        numeric = central_difference(
            MODEL, lambda at, n=n: (moved[n] @ SKIN.shares(at)[..., None]).ravel(), q
        )
        assert_near((found - before)[n].reshape(-1, MODEL.nv), numeric, 1e-8)


def test_known_displacements_add_up_by_their_shares():
    rng = np.random.default_rng(2)
    q, slides = moderate_pose(MODEL, rng), rng.normal(0.0, 0.01, (len(SEGMENTS), SKIN.flexions, 3))
    expected = np.einsum("md,mdi->mi", SKIN.shares(q), slides)
    assert_near(SKIN.displacement(slides).at(q), expected, 1e-15)


def test_markers_of_a_segment_move_together_for_the_most_part():
    prior = slide_covariance(MODEL.description, SEGMENTS)
    assert len(prior) == flexions_of(MODEL.description, SEGMENTS) == SKIN.flexions
    skin = MODEL.description.skin["left_thigh"]
    x = prior[0].reshape(len(SEGMENTS), 3, len(SEGMENTS), 3)[:, 0, :, 0]
    assert x[2, 2] == pytest.approx(skin.common_m**2 + skin.own_m**2)
    assert x[2, 4] == pytest.approx(skin.common_m**2)
    assert x[0, 2] == 0.0
    assert np.linalg.eigvalsh(prior[0]).min() > 0.0
    assert slide_covariance(MODEL.description, ["head", ""]).shape == (0, 6, 6)
