"""World frames, quaternion algebra, and the attitude two vectors give."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mbkf.errors import UnknownName
from mbkf.imu import frames


def rotations(seed, count=20):
    return Rotation.random(count, rng=np.random.default_rng(seed))


@given(st.integers(0, 1000))
def test_algebra_is_that_of_rotations(seed):
    a, b = rotations(seed), rotations(seed + 1)
    vectors = np.random.default_rng(seed).normal(size=(20, 3))
    product = frames.multiply(a.as_quat(), b.as_quat())
    np.testing.assert_allclose(Rotation.from_quat(product).as_matrix(), (a * b).as_matrix(), atol=1e-12)
    np.testing.assert_allclose(frames.rotate(a.as_quat(), vectors), a.apply(vectors), atol=1e-12)
    turn = np.random.default_rng(seed).normal(size=(20, 3)) * np.logspace(-9, 0.4, 20)[:, None]
    found = Rotation.from_quat(frames.exponential(turn)).as_matrix()
    np.testing.assert_allclose(found, Rotation.from_rotvec(turn).as_matrix(), atol=1e-12)
    back = frames.matrix_quaternion(a.as_matrix())
    assert (back[:, 3] >= 0).all()
    np.testing.assert_allclose(Rotation.from_quat(back).as_matrix(), a.as_matrix(), atol=1e-12)


@pytest.mark.parametrize("turn", np.vstack([np.pi * np.eye(3), -np.pi * np.eye(3), np.zeros(3)]))
def test_half_turns_have_a_quaternion(turn):
    R = Rotation.from_rotvec(turn).as_matrix()
    found = frames.matrix_quaternion(R)
    np.testing.assert_allclose(Rotation.from_quat(found).as_matrix(), R, atol=1e-12)


def test_the_three_frames_name_the_same_directions():
    north, west, up = np.eye(3)
    expected = {"NWU": (north, west, up), "ENU": (west, -north, up), "NED": (north, -west, -up)}
    for frame, directions in expected.items():
        for one, seen in zip(np.eye(3), directions, strict=True):
            np.testing.assert_allclose(frames.rotate(frames.FRAMES[frame], one), seen, atol=1e-12)


@given(st.sampled_from(["ENU", "NED", "NWU"]), st.sampled_from(["ENU", "NED", "NWU"]), st.integers(0, 100))
def test_changing_frames_and_back_changes_nothing(first, second, seed):
    q = rotations(seed).as_quat()
    there = frames.change_frame(q, first, second)
    back = frames.change_frame(there, second, first)
    assert np.abs((back * q).sum(axis=1)) == pytest.approx(np.ones(20))
    with pytest.raises(UnknownName, match="ENU"):
        frames.change_frame(q, first, "EUN")


@given(st.integers(0, 1000))
def test_attitude_explains_the_vectors_it_is_made_of(seed):
    R = rotations(seed)
    up, field = R.inv().apply([0.0, 0.0, 9.8]), R.inv().apply([20.0, 0.0, -40.0])
    found = frames.attitude(up, field)
    np.testing.assert_allclose(Rotation.from_quat(found).as_matrix(), R.as_matrix(), atol=1e-9)
    level = frames.attitude(up)
    np.testing.assert_allclose(frames.rotate(level, up), np.tile([0, 0, 9.8], (20, 1)), atol=1e-9)


def test_an_upside_down_sensor_has_an_attitude():
    np.testing.assert_allclose(
        frames.rotate(frames.attitude(np.array([0, 0, -9.8])), np.array([0, 0, -9.8])), [0, 0, 9.8]
    )
