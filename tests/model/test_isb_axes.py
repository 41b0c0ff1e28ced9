"""The ISB's axes: which points lie on which axis, and both sides alike."""

import numpy as np
import pytest

from mbkf.model.isb_axes import isb_axes

MIRROR = np.array([1.0, -1.0, 1.0])
RIGHT = {
    "asis": (0.06, -0.12, 1.0),
    "hip_centre": (0.0, -0.08, 0.93),
    "knee": (0.01, -0.15, 0.5),
    "knee_medial": (0.0, -0.04, 0.51),
    "ankle": (-0.02, -0.13, 0.09),
    "ankle_medial": (0.01, -0.05, 0.1),
}
PLACES = {f"right_{name}": np.array(place) for name, place in RIGHT.items()}
PLACES |= {f"left_{name}": MIRROR * place for name, place in RIGHT.items()}
PLACES["sacrum"] = np.array([-0.11, 0.0, 1.02])
JOINTS = isb_axes(PLACES).joints


def middle(name):
    return 0.5 * (PLACES[name] + PLACES[f"{name}_medial"])


def along(vector):
    return vector / np.linalg.norm(vector)


def test_axes_are_rotations_near_the_bodys():
    for axes in JOINTS.values():
        for R in (axes.proximal, axes.distal):
            np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
            assert np.linalg.det(R) > 0 and np.trace(R) > 1 + 2 * np.cos(np.deg2rad(30))


def test_sides_mirror_each_other():
    flip = np.diag(MIRROR)
    for joint in ("hip", "knee", "ankle"):
        right, left = JOINTS[f"{joint}_r"], JOINTS[f"{joint}_l"]
        np.testing.assert_allclose(left.proximal, flip @ right.proximal @ flip, atol=1e-12)
        np.testing.assert_allclose(left.distal, flip @ right.distal @ flip, atol=1e-12)


@pytest.mark.parametrize(("suffix", "side", "leftward"), [("r", "right", 1.0), ("l", "left", -1.0)])
def test_points_lie_on_the_axes_that_they_define(suffix, side, leftward):
    """Wu: the femur's long axis ends in the hip centre, the malleoli on the shank's flexion axis at the ankle."""
    hip, knee, ankle = (JOINTS[f"{joint}_{suffix}"] for joint in ("hip", "knee", "ankle"))
    hip_centre, knee_centre, ankle_centre = (
        PLACES[f"{side}_hip_centre"],
        middle(f"{side}_knee"),
        middle(f"{side}_ankle"),
    )
    np.testing.assert_allclose(hip.distal[:, 2], along(hip_centre - knee_centre), atol=1e-12)
    np.testing.assert_array_equal(knee.proximal, hip.distal)
    np.testing.assert_allclose(knee.distal[:, 2], along(knee_centre - ankle_centre), atol=1e-12)
    across = leftward * (PLACES[f"{side}_ankle_medial"] - PLACES[f"{side}_ankle"])
    np.testing.assert_allclose(ankle.proximal[:, 1], along(across), atol=1e-12)
    assert ankle.proximal[:, 0] @ (knee_centre - ankle_centre) == pytest.approx(0.0, abs=1e-12)
    epicondyles = PLACES[f"{side}_knee_medial"] - PLACES[f"{side}_knee"]
    assert hip.distal[:, 0] @ epicondyles == pytest.approx(0.0, abs=1e-12)


def test_the_pelvis_lies_in_the_plane_of_both_asis_and_the_sacrum():
    pelvis = JOINTS["pelvis"].distal
    np.testing.assert_allclose(pelvis[:, 1], [0, 1, 0], atol=1e-12)
    assert pelvis[:, 2] @ (PLACES["right_asis"] - PLACES["sacrum"]) == pytest.approx(0.0, abs=1e-12)
