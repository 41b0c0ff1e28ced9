"""Plug-in Gait's axes: joint centres inside their markers, wands and their offsets, feet as lines."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.model.plug_in_gait import MARKER_RADIUS_M, measured_of, plug_in_gait

MIRROR = np.array([1.0, -1.0, 1.0])
RIGHT = {
    "asis": (0.06, -0.12, 1.0),
    "thigh_wand": (-0.01, -0.17, 0.72),
    "knee": (0.01, -0.15, 0.5),
    "knee_medial": (0.0, -0.04, 0.5),
    "knee_centre": (0.0, -0.09, 0.5),
    "shank_wand": (0.0, -0.16, 0.3),
    "ankle": (-0.01, -0.13, 0.09),
    "ankle_medial": (0.0, -0.05, 0.1),
    "ankle_centre": (0.0, -0.09, 0.095),
    "heel": (-0.06, -0.09, 0.04),
    "toe": (0.13, -0.1, 0.05),
}
PLACES = {f"right_{name}": np.array(place) for name, place in RIGHT.items()}
PLACES |= {f"left_{name}": MIRROR * place for name, place in RIGHT.items()}
THORAX = {
    "c7": (-0.09, 0.01, 1.5), "t10": (-0.1, 0.0, 1.25), "jugular_notch": (0.05, 0.0, 1.42), "xiphoid": (0.1, 0.0, 1.2),
}  # fmt: skip
PLACES["sacrum"] = np.array([-0.11, 0.0, 1.02])
STORED = {"RKNEEWIDTH": 100.0, "LKNEEWIDTH": 100.0, "RLEGLENGTH": 880.0, "LLEGLENGTH": 880.0}
JOINTS = ("hip_r", "knee_r", "ankle_r", "hip_l", "knee_l", "ankle_l")


def read(places=PLACES, **stored):
    return plug_in_gait(places, measured_of(STORED | stored)).joints


def test_axes_are_rotations_near_the_bodys():
    for axes in read().values():
        for R in (axes.proximal, axes.distal):
            np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
            assert np.linalg.det(R) > 0 and np.trace(R) > 1 + 2 * np.cos(np.deg2rad(25))


def test_sides_mirror_each_other():
    """Offsets are stored alike for both sides, but for the ankle's tilt, a turn about the body's own forward axis."""
    offsets = {"THIGHROTATION": (0.1, 0.1), "TIBIALTORSION": (-0.2, -0.2), "ANKLEABADD": (0.05, -0.05)}
    stored = {f"{side}{name}": both[k] for name, both in offsets.items() for k, side in enumerate("RL")}
    found, flip = read(**stored), np.diag(MIRROR)
    for joint in ("hip", "knee", "ankle"):
        right, left = found[f"{joint}_r"], found[f"{joint}_l"]
        np.testing.assert_allclose(left.proximal, flip @ right.proximal @ flip, atol=1e-8)
        np.testing.assert_allclose(left.distal, flip @ right.distal @ flip, atol=1e-8)


def test_the_pelvis_is_that_of_its_four_markers():
    pelvis = read()["pelvis"].distal
    np.testing.assert_allclose(pelvis[:, 1], [0, 1, 0], atol=1e-12)
    back_to_front = 0.5 * (PLACES["right_asis"] + PLACES["left_asis"]) - PLACES["sacrum"]
    np.testing.assert_allclose(pelvis[:, 0], back_to_front / np.linalg.norm(back_to_front), atol=1e-12)


def test_the_thorax_leans_as_the_line_between_its_pairs_of_markers():
    """Vicon's definition by hand: z between the middles of both pairs, y square to it and to the line to the front."""
    places = PLACES | {name: np.array(place) for name, place in THORAX.items()}
    found = plug_in_gait(places, measured_of(STORED)).trunk
    upper, lower = (0.5 * (places[a] + places[b]) for a, b in (("c7", "jugular_notch"), ("t10", "xiphoid")))
    np.testing.assert_allclose(found[:, 2], (upper - lower) / np.linalg.norm(upper - lower), atol=1e-12)
    front, back = (0.5 * (places[a] + places[b]) for a, b in (("jugular_notch", "xiphoid"), ("c7", "t10")))
    assert abs(found[:, 1] @ (front - back)) < 1e-12 and found[:, 0] @ (front - back) > 0
    assert plug_in_gait(PLACES, measured_of(STORED)).trunk is None


def hip_centre():
    """Davis' regression as printed, for a leg of 880 mm."""
    C, depth = 0.115 * 0.88 - 0.0153, 0.1288 * 0.88 - 0.04856 + MARKER_RADIUS_M
    x = C * np.cos(0.5) * np.sin(0.314) - depth * np.cos(0.314)
    z = -C * np.cos(0.5) * np.cos(0.314) - depth * np.sin(0.314)
    y = C * np.sin(0.5) - 0.12
    return np.array([0.06, 0.0, 1.0]) + read()["pelvis"].distal @ [x, y, z]


def test_the_knee_is_half_a_width_inside_its_marker_at_a_right_angle():
    """From hip centre, long axis and marker: the centre is where the long axis passes the marker."""
    thigh, hip, marker = read()["hip_r"].distal, hip_centre(), PLACES["right_knee"]
    along = (marker - hip) @ thigh[:, 2]
    centre = hip + along * thigh[:, 2]
    assert np.linalg.norm(marker - centre) == pytest.approx(0.05 + MARKER_RADIUS_M, abs=1e-9)
    np.testing.assert_allclose(thigh[:, 1], (centre - marker) / np.linalg.norm(centre - marker), atol=1e-9)
    across = np.cross(thigh[:, 1], thigh[:, 2])
    assert (PLACES["right_thigh_wand"] - centre) @ across == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("suffix", "side", "sign"), [("r", "right", -1.0), ("l", "left", 1.0)])
def test_a_wand_that_stands_off_as_told_changes_nothing(suffix, side, sign):
    thigh, offset = read()[f"hip_{suffix}"].distal, 0.15
    hip = hip_centre() * (MIRROR if side == "left" else 1.0)
    turn = Rotation.from_rotvec(sign * offset * thigh[:, 2]).as_matrix()
    moved = PLACES | {f"{side}_thigh_wand": hip + turn @ (PLACES[f"{side}_thigh_wand"] - hip)}
    name = side[0].upper() + "THIGHROTATION"
    np.testing.assert_allclose(read(moved, **{name: offset})[f"hip_{suffix}"].distal, thigh, atol=1e-8)
    assert np.abs(read(moved)[f"hip_{suffix}"].distal - thigh).max() > 0.1


def test_tibial_torsion_turns_the_knees_axis_from_the_ankles():
    found = read(RTIBIALTORSION=-0.25)
    knee, ankle = found["knee_r"].distal, found["ankle_r"].proximal
    np.testing.assert_allclose(knee[:, 2], ankle[:, 2], atol=1e-12)
    about = Rotation.from_matrix(ankle.T @ knee).as_rotvec()
    np.testing.assert_allclose(about, [0, 0, 0.25], atol=1e-12)


def test_without_offsets_a_foot_is_flat_and_points_from_heel_to_forefoot():
    foot = read()["ankle_r"].distal
    flat = (PLACES["right_toe"] - PLACES["right_heel"]) * [1, 1, 0]
    np.testing.assert_allclose(foot[:, 0], flat / np.linalg.norm(flat), atol=1e-12)


def test_offsets_of_the_static_trial_turn_the_foots_line():
    axes = read(RSTATICPLANTFLEX=0.2, RSTATICROTOFF=0.05)["ankle_r"]
    turned = axes.line.distal.T @ axes.distal
    expected = Rotation.from_euler("YZ", [-0.2, 0.05]).as_matrix()
    np.testing.assert_allclose(turned, expected, atol=1e-12)


def test_without_wands_the_joints_axes_are_those_of_their_two_sides():
    places = {name: place for name, place in PLACES.items() if "wand" not in name}
    thigh = read(places, RTHIGHROTATION=0.3)["hip_r"].distal
    across = PLACES["right_knee_medial"] - PLACES["right_knee"]
    assert np.cross(thigh[:, 1], thigh[:, 2]) @ across == pytest.approx(0.0, abs=1e-9)


def test_lengths_are_told_in_millimetres_and_zero_is_unknown():
    found = measured_of(
        {"RLEGLENGTH": 800.0, "LLEGLENGTH": 0.0, "INTERASISDISTANCE": 240.0, "RSTATICPLANTFLEX": 0.1}
    )
    assert found.leg_m == (0.8, None) and found.asis_m == 0.24
    assert found.foot_rad == (None, None) and found.torsion_rad == (0.0, 0.0)


def test_a_file_in_degrees_is_told_by_an_angle_beyond_a_right_one():
    """The offsets of a public file: a sole of 12.9° can be no 12.9 rad, and then 0.3 is in degrees as well."""
    stored = {"RSTATICPLANTFLEX": 12.891, "RSTATICROTOFF": 0.337, "LTHIGHROTATION": -3.0}
    found = measured_of(stored)
    np.testing.assert_allclose(found.foot_rad[0], np.deg2rad([12.891, 0.337]))
    assert found.thigh_rad == (0.0, pytest.approx(np.deg2rad(-3.0)))
    assert measured_of({"RSTATICPLANTFLEX": 0.22, "RSTATICROTOFF": 0.006}).foot_rad[0] == (0.22, 0.006)
