"""Starts of the fit: upright bodies of the cloud's height, facing all around."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.marker_sets.equipment import EQUIPMENTS
from mbkf.marker_sets.starts import ARMS_RAD, HEADINGS, SIZES, starts
from mbkf.model.human import HumanModel
from tests.marker_sets.worn import standing

MODEL = HumanModel.scaled()
WHOLE = EQUIPMENTS[0]
LEGS = next(one for one in EQUIPMENTS if one.name == "pelvis and legs")


def heading(start):
    turn = Rotation.from_quat(start.q[MODEL.root.q][3:]).as_matrix()
    return np.arctan2(turn[1, 0], turn[0, 0])


def cloud(height_m, low_m=0.1):
    rng = np.random.default_rng(1)
    points = rng.uniform([0.7, 1.7, 0.0], [1.3, 2.3, 0.0], (200, 3))
    points[:, 2] = np.linspace(low_m, low_m + height_m, 200)
    return points


def test_every_start_is_upright_above_the_cloud():
    points = cloud(1.6)
    for start in starts(MODEL, points, WHOLE):
        turn = Rotation.from_quat(start.q[MODEL.root.q][3:]).as_matrix()
        np.testing.assert_allclose(turn[:, 2], [0.0, 0.0, 1.0], atol=1e-12)
        np.testing.assert_allclose(start.q[:2], np.median(points[:, :2], axis=0))


def test_headings_go_round_in_equal_steps_with_every_posture_of_the_arms():
    found = list(starts(MODEL, cloud(1.6), WHOLE))
    assert len(found) == len(WHOLE.top_m) * HEADINGS * len(ARMS_RAD)
    steps = np.sort(np.mod([heading(one) for one in found], 2 * np.pi - 1e-9))
    np.testing.assert_allclose(
        np.unique(steps.round(6)), np.arange(HEADINGS) * 2 * np.pi / HEADINGS, atol=1e-6
    )


def test_arms_are_not_tried_where_they_carry_nothing():
    assert len(list(starts(MODEL, cloud(0.9), LEGS))) == len(LEGS.top_m) * HEADINGS


def test_the_soles_are_as_far_below_the_lowest_point_as_the_equipment_says():
    points = cloud(1.5)
    low = np.percentile(points[:, 2], 1.0)
    sole = MODEL.description.sole
    for start in starts(MODEL, points, WHOLE):
        model = HumanModel(MODEL.description, start.size * np.ones_like(MODEL.scale), 70.0)
        floor = (
            model.placements(start.q)[1][model.joint(sole.segment).joint_id][2] + start.size * sole.height_m
        )
        assert floor == pytest.approx(low - start.size * WHOLE.bottom_m, abs=1e-9)


@pytest.mark.parametrize("height_m", [1.2, 1.55, 1.9])
def test_one_of_the_sizes_is_the_persons(height_m):
    worn = standing("autolabel62", 3, height_m=height_m)
    sizes = {start.size for start in starts(MODEL, worn.points_m, WHOLE)}
    true = height_m / MODEL.description.reference_height_m
    assert min(abs(size / true - 1.0) for size in sizes) < 0.06


def test_no_person_is_so_small_or_so_tall():
    for height_m in (0.3, 3.0):
        assert list(starts(MODEL, cloud(height_m), WHOLE)) == []
    for start in starts(MODEL, cloud(1.0), WHOLE):
        assert SIZES[0] <= start.size <= SIZES[1]
