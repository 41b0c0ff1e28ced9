"""Starts of a limb's fit: poses turned over, and orders of names that fit."""

import numpy as np

from mbkf.sensors.limb_fit import LimbFits
from mbkf.sensors.limb_starts import (
    likely_pairs,
    next_joint,
    opposite_markers,
    order_starts,
    pose_starts,
    turned_over,
)
from tests.motions import moderate_pose, protocol_sensor, reference_model

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
FITS = LimbFits(SENSOR, np.full(36, 0.005), np.zeros(MODEL.nv, dtype=bool))
LEG = next(one for one in FITS.limbs if one.name == "left_thigh")


def test_a_segment_turned_over_carries_the_rest_where_it_was():
    q = moderate_pose(MODEL, np.random.default_rng(1))
    thigh, shank = LEG.joints[0], next_joint(MODEL, LEG, LEG.joints[0])
    assert shank.segment == "left_shank"
    found = turned_over(MODEL, q, thigh, shank)
    (axes, origins), (turned, there) = MODEL.placements(q), MODEL.placements(found)
    np.testing.assert_allclose(there, origins, atol=1e-9)
    others = np.arange(len(axes)) != thigh.joint_id
    np.testing.assert_allclose(turned[others], axes[others], atol=1e-9)
    half = turned[thigh.joint_id] @ axes[thigh.joint_id].T
    assert abs(np.trace(half) + 1.0) < 1e-9
    along = origins[shank.joint_id] - origins[thigh.joint_id]
    np.testing.assert_allclose(half @ along, along, atol=1e-9)


def test_one_of_the_starts_is_right_from_every_wrong_one():
    right = moderate_pose(MODEL, np.random.default_rng(2), spread=0.2)
    seen = SENSOR.positions(right)
    thigh, shank = LEG.joints[:2]
    wrong = turned_over(MODEL, right, thigh, shank)
    starts = list(pose_starts(FITS, LEG, wrong, seen))
    np.testing.assert_array_equal(starts[0], wrong)
    assert min(np.abs(MODEL.difference(right, one)[LEG.dofs]).max() for one in starts) < 1e-6


def test_exchanged_names_are_found_with_a_marker_hidden():
    rng = np.random.default_rng(4)
    local = rng.normal(size=(6, 3)) * 0.1
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    seen = local @ turn.T + 1.0
    seen[[0, 2, 3, 5]] = seen[[2, 0, 5, 3]]
    assert likely_pairs(local, seen)[0] == ((0, 2), (3, 5))
    seen[0] = np.nan
    assert ((0, 2), (3, 5)) in likely_pairs(local, seen)


def test_names_as_they_are_are_no_exchange():
    rng = np.random.default_rng(5)
    local = rng.normal(size=(5, 3)) * 0.2
    assert () not in likely_pairs(local, local + 1.0)


def test_the_other_side_s_markers_mirror_each_other():
    found = opposite_markers(SENSOR)
    assert found and all(found[other] == m for m, other in found.items())
    for m, other in found.items():
        assert {SENSOR.segments[m].split("_")[0], SENSOR.segments[other].split("_")[0]} == {"left", "right"}
    own = FITS.on_limb[FITS.limbs.index(LEG)]
    whole = [
        one for one in order_starts(FITS, LEG, SENSOR.positions(MODEL.neutral()), np.zeros(36, dtype=bool))
    ][-1]
    np.testing.assert_array_equal(whole[whole], np.arange(36))
    assert (whole[own] != np.flatnonzero(own)).any()
