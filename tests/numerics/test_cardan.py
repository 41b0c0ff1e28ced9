"""Cardan angles: they give back their rotation, their maps are derivatives, and they continue in time."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.numerics.cardan import (
    cardan_angles,
    follow,
    near_singularity,
    quaternion_matrices,
    rate_map,
    rotation_matrix,
    unit_quaternions,
    velocity_map,
)

ORDERS = ["".join(order) for order in itertools.permutations("XYZ")]


def basis(order):
    axes = ["XYZ".index(axis) for axis in order]
    return axes, round(np.linalg.det(np.eye(3)[axes]))


def in_basis(R, axes):
    return R[..., axes, :][..., axes]


@pytest.mark.parametrize("order", ORDERS)
def test_angles_of_every_order_agree_with_scipy(order):
    rotations = Rotation.random(200, rng=1)
    axes, parity = basis(order)
    angles = cardan_angles(in_basis(rotations.as_matrix(), axes), parity)
    np.testing.assert_allclose(angles, rotations.as_euler(order), atol=1e-12)


def test_quaternion_matrices_agree_with_scipy():
    rotations = Rotation.random(50, rng=2)
    found = quaternion_matrices(rotations.as_quat())
    np.testing.assert_allclose(found, rotations.as_matrix(), atol=1e-14)
    np.testing.assert_array_equal(found, [rotation_matrix(one) for one in rotations.as_quat()])


@pytest.mark.parametrize("order", ORDERS)
def test_velocity_map_is_the_derivative_and_rate_map_its_inverse(order):
    axes, parity = basis(order)
    rng = np.random.default_rng(3)
    angles, rates, step = rng.uniform(-1.2, 1.2, (40, 3)), rng.normal(size=(40, 3)), 1e-6
    before, after = (Rotation.from_euler(order, angles + s * step * rates) for s in (-1, 1))
    omega = (before.inv() * after).as_rotvec() / (2 * step)
    B, E = velocity_map(angles, parity), rate_map(angles, parity)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", B, rates), omega[:, axes], atol=1e-8)
    np.testing.assert_allclose(E @ B, np.broadcast_to(np.eye(3), B.shape), atol=1e-12)


def test_rates_stay_finite_at_the_singularity():
    angles = np.array([0.3, np.pi / 2, 0.1])
    assert np.isfinite(rate_map(angles, -1)).all()
    assert near_singularity(angles)
    assert not near_singularity(np.array([0.0, np.deg2rad(79.0), 0.0]))
    assert not near_singularity(np.full(3, np.nan))


def series(order, angles):
    axes, parity = basis(order)
    return cardan_angles(in_basis(Rotation.from_euler(order, angles).as_matrix(), axes), parity)[:, None]


def test_a_joint_lifted_through_the_singularity_and_back_stays_continuous():
    lift = np.deg2rad(150.0) * np.sin(np.linspace(0, np.pi, 101))
    angles = np.column_stack([0.2 + 0 * lift, -lift, -0.1 + 0 * lift])
    principal = series("YXZ", angles)
    assert np.abs(principal[:, 0] - angles).max() > 3.0
    np.testing.assert_allclose(follow(principal, np.array([False]))[:, 0], angles, atol=1e-9)


def test_a_root_that_turns_round_and_round_keeps_counting_over_missing_frames():
    yaw = np.linspace(0, 6 * np.pi, 200)
    angles = np.column_stack([0.1 + 0 * yaw, 0 * yaw, yaw])
    principal = series("YXZ", angles)
    principal[50:60] = np.nan
    followed = follow(principal, np.array([True]))[:, 0]
    kept = np.isfinite(followed[:, 0])
    assert kept.sum() == 190
    np.testing.assert_allclose(followed[kept], angles[kept], atol=1e-9)


def test_following_frame_by_frame_equals_following_all_at_once():
    rng = np.random.default_rng(4)
    angles = np.cumsum(rng.normal(scale=0.3, size=(300, 3)), axis=0)
    tame = series("XYZ", 0.1 * angles)
    principal = np.concatenate([series("XYZ", angles), tame, series("XYZ", -angles)], axis=1)
    principal[40:50], principal[:3, 1] = np.nan, np.nan
    winds = np.array([True, False, False])
    whole, last, single = follow(principal, winds), np.full((3, 3), np.nan), []
    for frame in principal:
        single.append(follow(frame[None], winds, last)[0])
        last = np.where(np.isnan(single[-1]), last, single[-1])
    np.testing.assert_array_equal(whole, single)


def test_one_bad_frame_at_the_singularity_does_no_lasting_harm():
    angles = np.zeros((9, 3))
    angles[4] = [3.0, 1.57, 3.0]
    followed = follow(series("YXZ", angles), np.array([False]))[:, 0]
    np.testing.assert_allclose(followed[5:], 0.0, atol=1e-12)
    assert follow(np.empty((0, 1, 3)), np.array([False])).shape == (0, 1, 3)


def test_quaternions_get_length_one_and_those_that_are_not_rotations_are_missing():
    one = np.array([0.5, -0.5, 0.5, 0.5])
    lengths = np.array([0.51, 1.0, 1.99, 0.49, 2.01, 0.0, np.inf, np.nan])
    with np.errstate(invalid="ignore"):
        given = lengths[:, None] * one
    np.testing.assert_allclose(unit_quaternions(given)[:3], [one] * 3, rtol=1e-15)
    assert np.isnan(unit_quaternions(given)[3:]).all()
