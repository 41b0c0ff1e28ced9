"""Angular velocity and specific force by differences: exact where turning and acceleration are even."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.stream.xsens.readings import BACK, HELD_S, Differences, OrientedFrame

RATE_HZ, OMEGA = 50.0, np.array([0.3, -1.0, 2.0])
FREE = np.array([1.0, 2.0, -3.0])


def frame(number, accelerations=False):
    """A box that turns evenly about its own axes and is evenly accelerated."""
    t = number / RATE_HZ
    turns = (Rotation.from_rotvec([0.5, 0.2, -0.1]) * Rotation.from_rotvec(OMEGA * t)).as_quat()
    places = None if accelerations else 0.5 * FREE * t**2
    return OrientedFrame(
        number,
        t,
        turns[None],
        None if places is None else places[None],
        FREE[None] if accelerations else None,
        np.full((1, 6), np.nan),
    )


def run(frames):
    held = Differences(RATE_HZ)
    return [found for one in frames for found in held.put(one)]


@pytest.mark.parametrize("accelerations", [True, False])
def test_a_frame_between_its_neighbours(accelerations):
    found = run([frame(k, accelerations) for k in range(4)])
    assert [one.number for one in found] == [0, 1, 2]
    assert np.isnan(found[0].imus).all()
    for one in found[1:]:
        felt = Rotation.from_quat(one.turns[0]).inv().apply(FREE + np.array([0.0, 0.0, GRAVITY_M_S2]))
        np.testing.assert_allclose(one.imus[0, :3], OMEGA, atol=1e-12)
        np.testing.assert_allclose(one.imus[0, 3:], felt, atol=1e-9)


def test_a_quaternion_of_the_other_sign_is_the_same_rotation():
    frames = [frame(k) for k in range(3)]
    frames[1] = replace(frames[1], turns=-frames[1].turns)
    np.testing.assert_allclose(run(frames)[1].imus[0, :3], OMEGA, atol=1e-12)


def test_beside_a_lost_frame_the_orientation_alone_is_known():
    found = run([frame(k) for k in (0, 1, 2, 4, 5, 6, 7)])
    known = {one.number: bool(np.isfinite(one.imus).all()) for one in found}
    assert known == {0: False, 1: True, 2: False, 4: False, 5: True, 6: True}
    assert all(np.isfinite(one.turns).all() for one in found)


def test_a_sensor_that_is_missing_leaves_the_others():
    frames = [replace(frame(k), turns=np.repeat(frame(k).turns, 2, axis=0)) for k in range(3)]
    frames = [
        replace(one, places_m=np.repeat(one.places_m, 2, axis=0), imus=np.full((2, 6), np.nan))
        for one in frames
    ]
    frames[2].turns[0] = np.nan
    imus = run(frames)[1].imus
    assert np.isnan(imus[0]).all() and np.isfinite(imus[1]).all()


def test_late_and_doubled_frames_follow_the_one_that_waits():
    assert [one.number for one in run([frame(k) for k in (0, 1, 2, 2, 1, 3, 4)])] == [0, 1, 2, 2, 1, 3]


def test_a_count_far_back_begins_anew():
    found = run([frame(k) for k in (1000, 1001, 1002 - BACK - 2, 1003 - BACK - 2, 1004 - BACK - 2)])
    assert [one.number for one in found] == [1000, 1001, 1000 - BACK, 1001 - BACK]
    assert np.isnan(found[2].imus).all() and np.isfinite(found[3].imus).all()


def test_a_frame_that_nothing_follows_is_given_after_a_while():
    held = Differences(RATE_HZ)
    assert not list(held.put(frame(0))) and not list(held.due(HELD_S))
    (found,) = held.due(1.01 * HELD_S)
    assert found.number == 0 and not list(held.due(9.0))
