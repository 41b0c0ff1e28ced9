"""Frames that count: whose torques an estimated load changes, and how well they have to be known."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.contacts import Source
from mbkf.model.clinical import ClinicalAngles
from mbkf.trial.results.validity import (
    MOST_NM_PER_KG,
    TORQUE_SD_NM_PER_KG,
    WALKING_SHARE,
    joints_to_root,
    torques_known,
    torques_possible,
)
from tests.motions import reference_model

NAMES = ClinicalAngles(reference_model()).names
PARTS = tuple(reference_model().description.bearings)
MOST_NM = TORQUE_SD_NM_PER_KG * reference_model().mass_kg


def known(uncertain, feet=(Source.MEASURED, Source.MEASURED), bears=(), sd_nm=1.01 * MOST_NM):
    """Whether one frame counts in which a coordinate's moment is uncertain, all others known."""
    sd = np.zeros((1, len(NAMES)))
    if uncertain:
        sd[0, NAMES.index(uncertain)] = sd_nm
    loaded = np.array([[part in bears for part in PARTS]])
    return bool(torques_known(reference_model(), NAMES, sd, np.array([feet]), np.zeros((1, 2)), loaded)[0])


@pytest.mark.parametrize(
    ("segment", "joints"),
    [
        ("right_foot", ["right_foot", "right_shank", "right_thigh"]),
        ("torso", ["torso"]),
        ("left_hand", ["left_hand", "left_forearm", "left_upper_arm", "torso"]),
        ("pelvis", []),
    ],
)
def test_a_load_changes_the_joints_between_its_part_and_the_root(segment, joints):
    """They are those whose dofs move the part."""
    model = reference_model()
    assert joints_to_root(model, segment) == joints
    moved = model.supports[model.joint(segment).joint_id]
    dofs = {i for joint in joints for i in range(*model.joint(joint).v.indices(model.nv))}
    assert dofs == set(np.flatnonzero(moved)) - set(range(6))


def test_measured_loads_are_not_asked():
    assert known("knee_angle_r", sd_nm=np.nan)
    assert known("knee_angle_r", feet=(Source.NONE, Source.MEASURED), sd_nm=1e3)


@pytest.mark.parametrize("source", [Source.ESTIMATED, Source.SHARED])
def test_an_estimated_foot_has_to_leave_its_own_leg_known(source):
    feet = (Source.MEASURED, source)
    assert known("", feet)
    for joint in ("hip_flexion", "knee_angle", "ankle_angle"):
        assert not known(f"{joint}_l", feet)
        assert known(f"{joint}_l", feet, sd_nm=0.99 * MOST_NM)
        assert not known(f"{joint}_l", feet, sd_nm=np.nan)
        assert known(f"{joint}_r", feet), "the other leg is measured"
    assert known("hip_rotation_l", feet), "flexion torques count"
    assert known("mtp_angle_l", feet), "toes have no torque of their own"


def test_other_parts_have_to_leave_the_joints_up_to_the_pelvis_known():
    assert not known("elbow_flex_r", bears=("right_hand",))
    assert not known("lumbar_extension", bears=("right_hand",))
    assert known("elbow_flex_l", bears=("right_hand",))
    assert known("knee_angle_r", bears=("right_hand", "pelvis"))
    assert not known("hip_flexion_r", bears=("right_knee",))
    assert known("ankle_angle_r", bears=("right_knee",))


def test_a_filter_that_asks_for_no_other_parts():
    sd = np.full((3, len(NAMES)), np.nan)
    source = np.array([[1, 1], [3, 0], [0, 2]])
    force_n, bears = np.full((3, 2), np.nan), np.zeros((3, 0), bool)
    assert torques_known(reference_model(), NAMES, sd, source, force_n, bears).tolist() == [
        True,
        False,
        False,
    ]


def test_the_bound_grows_with_the_largest_force_of_a_contact():
    """Two contacts of one foot: one as hard as running, one as light as walking; the other foot's is no matter."""
    sd = np.zeros((7, len(NAMES)))
    sd[:, NAMES.index("knee_angle_l")] = 1.9 * MOST_NM
    force = np.array([[0.0, 0.1], [0.0, 2.0], [0.0, 0.1], [3.0, 0.0], [0.0, 0.4], [0.0, 1.0], [0.0, 0.4]])
    source = np.where(force > 0.0, Source.ESTIMATED, Source.NONE)
    force_n = WALKING_SHARE * GRAVITY_M_S2 * reference_model().mass_kg * force
    bears = np.zeros((7, 0), bool)

    def counts(force_n):
        return torques_known(reference_model(), NAMES, sd, source, force_n, bears).tolist()

    assert counts(force_n) == [True, True, True, True, False, False, False]
    assert counts(0.94 * force_n) == [False, False, False, True, False, False, False]


def test_a_torque_that_no_joint_bears_is_not_possible():
    tau = np.zeros((5, 8))
    tau[0, 0] = 1e6  # the root's
    tau[1, 6], tau[2, 7] = 0.99 * MOST_NM_PER_KG * 70.0, -1.01 * MOST_NM_PER_KG * 70.0
    tau[3, 6] = np.nan
    tau[4, 7] = np.inf
    assert torques_possible(tau, 6, 70.0).tolist() == [True, True, False, True, False]
