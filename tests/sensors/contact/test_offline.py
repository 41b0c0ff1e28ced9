"""Plates assigned to feet over whole trials, and the frames in which every contact is measured."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.records import PlateReadings
from mbkf.sensors.contact.offline import assign_feet
from mbkf.sensors.contact.rules import BOTH
from mbkf.sensors.contact.sharing import expected_stance
from mbkf.sensors.contact.soles import sole_points
from tests.motions import assert_near, reference_model

MODEL = reference_model()
RATE_HZ, PLATE_RATE_HZ = 100.0, 1000.0
WEIGHT_N = MODEL.mass_kg * GRAVITY_M_S2
RIGHT, LEFT, NEITHER = 0, 1, -1


def standing(yaw=0.0, lifted=None, z=0.0, at=(0.0, 0.0)):
    """Neutral posture with the soles on the floor; one foot lifted by bending hip and knee."""
    q = MODEL.neutral()
    if lifted is not None:
        for segment, degrees in ((f"{lifted}_thigh", -40), (f"{lifted}_shank", 80)):
            q[MODEL.joint(segment).q] = Rotation.from_euler("y", degrees, degrees=True).as_quat()
    ground = sole_points(MODEL, MODEL.neutral()[None])[0, :, :, 2].min()
    q[:3] = [*at, z - ground]
    q[3:7] = Rotation.from_euler("z", yaw).as_quat()
    return q


def on_the_right_foot(frames):
    """Stands on both feet for the first six frames, which shows where the floor is, then on the right one."""
    return np.array([standing()] * 6 + [standing(lifted="left")] * (frames - 6))


def ball(q, side):
    return sole_points(MODEL, q[None])[0, side, 1]


def plate(at, vertical_n, frames, start_s=0.0, free_nm=0.0, height_m=0.0, half_m=0.09):
    """A plate whose load acts at ``at`` (x, y, …), with a vertical force given per frame (or one for all).

    It lies about that point and is too small for two feet unless ``half_m`` says otherwise.
    """
    fz = np.repeat(np.broadcast_to(np.asarray(vertical_n, float), frames), int(PLATE_RATE_HZ / RATE_HZ))
    force = np.stack([0.1 * fz, -0.05 * fz, fz], axis=1)
    origin = np.array([at[0] + 0.1, at[1] - 0.05, height_m])
    point = np.array([at[0], at[1], height_m])
    moment = np.cross(point - origin, force) + np.outer(fz > 0, [0.0, 0.0, free_nm])
    pressure = np.where((fz > 20)[:, None], point, np.nan)
    corners = point + half_m * np.array([[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]])
    return PlateReadings("1", PLATE_RATE_HZ, start_s, origin, force, moment, pressure, 20.0, corners)


def assigned(q, plates):
    return assign_feet(MODEL, q, np.arange(len(q)) / RATE_HZ, RATE_HZ, tuple(plates))


@pytest.mark.parametrize("yaw", [0.0, 1.0, np.pi, -2.0])
def test_each_foot_has_its_own_plate_whichever_way_it_faces(yaw):
    q = np.repeat(standing(yaw)[None], 20, axis=0)
    left = plate(ball(q[0], LEFT), 0.6 * WEIGHT_N, 20, free_nm=3.0)
    loads = assigned(q, [left, plate(ball(q[0], RIGHT), 0.4 * WEIGHT_N, 20)])
    assert (loads.foot_of_plate == [LEFT, RIGHT]).all()
    assert loads.valid.all()
    assert loads.warnings == ()
    for side, share, free in ((RIGHT, 0.4, 0.0), (LEFT, 0.6, 3.0)):
        force, at = share * WEIGHT_N * np.array([0.1, -0.05, 1.0]), ball(q[0], side) * [1, 1, 0]
        moment = np.cross(at, force) + np.array([0, 0, free])
        assert_near(loads.wrench[:, side], np.tile(np.hstack([force, moment]), (20, 1)), 1e-10)
        assert_near(loads.centre_of_pressure_m[:, side], np.tile(at, (20, 1)), 1e-13)
        assert_near(loads.free_moment_nm[:, side], free, 1e-12)


def test_wrenches_of_the_feet_are_those_of_the_plates():
    q = np.repeat(standing()[None], 10, axis=0)
    strong, left = ball(q[0], RIGHT), ball(q[0], LEFT)
    weak = strong + np.array([0.03, 0, 0])
    loads = assigned(q, [plate(strong, 300.0, 10), plate(weak, 250.0, 10), plate(left, 250.0, 10)])
    assert (loads.foot_of_plate == [RIGHT, RIGHT, LEFT]).all()
    assert_near(loads.wrench.sum(axis=1), loads.plate_wrench.sum(axis=1), 1e-12)
    assert_near(loads.centre_of_pressure_m[:, RIGHT, :2], np.tile(strong[:2], (10, 1)), 1e-13)


def test_two_feet_one_after_the_other_on_one_plate():
    """Right foot, nothing, then the left foot on the same spot: each stretch of loading has its own foot."""
    right_first = standing(lifted="left")
    spot = ball(right_first, RIGHT)
    shift = spot - ball(standing(lifted="right"), LEFT)
    left_next = standing(lifted="right", at=shift[:2])
    q = np.array([right_first] * 40 + [left_next] * 40)
    load = np.r_[np.full(35, WEIGHT_N), np.zeros(10), np.full(35, WEIGHT_N)]
    foot = assigned(q, [plate(spot, load, 80)]).foot_of_plate[:, 0]
    assert (foot[:34] == RIGHT).all()
    assert (foot[36:44] == NEITHER).all()
    assert (foot[46:] == LEFT).all()


def test_two_feet_on_one_plate_share_it_by_where_they_stand():
    q = np.repeat(standing()[None], 20, axis=0)
    centres = expected_stance(sole_points(MODEL, q[:1])[0].tolist(), 0.0).centres_m
    for share in (0.5, 0.3):
        pressed = share * centres[RIGHT] + (1 - share) * centres[LEFT]
        loads = assigned(q, [plate(pressed, WEIGHT_N, 20, free_nm=2.0, half_m=0.5)])
        assert (loads.foot_of_plate == BOTH).all()
        assert loads.valid.all()
        assert_near(loads.wrench.sum(axis=1), loads.plate_wrench[:, 0], 1e-9)
        assert_near(loads.wrench[:, RIGHT, 2], share * WEIGHT_N, 1e-9)
        assert_near(loads.centre_of_pressure_m, np.tile(centres, (20, 1, 1)), 1e-9)
        at_feet = np.cross(loads.centre_of_pressure_m, loads.wrench[:, :, :3])
        at_feet[:, :, 2] += loads.free_moment_nm
        assert_near(loads.wrench[:, :, 3:], at_feet, 1e-9)


def test_a_plate_beside_the_shared_one_counts_for_both():
    q = np.repeat(standing()[None], 20, axis=0)
    middle = 0.5 * (ball(q[0], RIGHT) + ball(q[0], LEFT))
    beside = plate(ball(q[0], RIGHT), 100.0, 20, half_m=0.02)
    loads = assigned(q, [plate(middle, WEIGHT_N - 100.0, 20, half_m=0.5), beside])
    assert (loads.foot_of_plate == [BOTH, RIGHT]).all()
    assert_near(loads.wrench.sum(axis=1), loads.plate_wrench.sum(axis=1), 1e-9)


def test_feet_on_a_plate_without_an_outline_are_not_told_apart():
    q = np.repeat(standing()[None], 20, axis=0)
    middle = 0.5 * (ball(q[0], RIGHT) + ball(q[0], LEFT))
    unknown = replace(plate(middle, WEIGHT_N, 20), corners_m=None)
    assert (assigned(q, [unknown]).foot_of_plate == RIGHT).all()


def moving(speeds_m_s, frames=30):
    """Standing feet that are carried along x at a speed each (the hips bend)."""
    times = (np.arange(frames) - frames // 2) / RATE_HZ
    q = np.repeat(standing()[None], frames, axis=0)
    height = standing()[2] - 0.05
    for segment, speed in zip(("right_thigh", "left_thigh"), speeds_m_s, strict=True):
        turn = Rotation.from_rotvec(np.outer(-np.arctan(speed * times / height), [0.0, 1.0, 0.0]))
        q[:, MODEL.joint(segment).q] = turn.as_quat()
    return q


@pytest.mark.parametrize(
    ("speeds", "belt_m_s", "owner"),
    [((0.0, 0.0), 0.0, BOTH), ((0.0, 0.0), 2.0, BOTH), ((0.3, -0.3), 1.3, BOTH), ((2.0, -0.5), 1.3, RIGHT)],
)
def test_feet_that_pass_each_other_do_not_share_and_feet_on_a_belt_do(speeds, belt_m_s, owner):
    """What counts is how fast the soles move against each other, not against the plate."""
    q = moving(speeds)
    middle = len(q) // 2
    q[:, 0] -= belt_m_s * (np.arange(len(q)) - middle) / RATE_HZ
    feet = sole_points(MODEL, q)
    pressed = plate([0.0, 0.0], 0.0, len(q), half_m=3.0)
    at = np.repeat(feet[:, RIGHT, 1] * [1, 1, 0], int(PLATE_RATE_HZ / RATE_HZ), axis=0)
    force = np.tile([0.0, 0.0, WEIGHT_N], (len(at), 1))
    pressed = replace(pressed, force_n=force, moment_nm=np.cross(at - pressed.origin_m, force))
    near = np.abs(np.arange(len(q)) - middle) <= 3
    assert (assigned(q, [pressed]).foot_of_plate[near, 0] == owner).all()


def test_a_foot_beside_the_plates_makes_a_frame_invalid():
    q = np.repeat(standing()[None], 20, axis=0)
    loads = assigned(q, [plate(ball(q[0], RIGHT), 0.5 * WEIGHT_N, 20)])
    assert (loads.foot_of_plate == RIGHT).all()
    assert not loads.valid.any()
    assert loads.warnings == (
        "no frame has every loaded foot on a recorded plate; check the plates' places and recordings",
    )


def test_standing_on_one_foot_is_measured_by_one_plate():
    q = on_the_right_foot(30)
    loads = assigned(q, [plate(ball(q[0], RIGHT), WEIGHT_N, 30)])
    assert not loads.valid[:5].any()
    assert loads.valid[7:].all()


def test_a_load_with_no_foot_near_is_stray():
    q = on_the_right_foot(30)
    far = plate([1.5, 0.0], np.r_[np.zeros(20), np.full(10, 300.0)], 30)
    loads = assigned(q, [plate(ball(q[0], RIGHT), WEIGHT_N, 30), far])
    assert (loads.foot_of_plate == [RIGHT, NEITHER]).all()
    assert loads.valid[7:20].all()
    assert not loads.valid[20:].any()
    assert_near(loads.wrench[:, :, 2].sum(axis=1), WEIGHT_N, 1e-10)
    assert len(loads.warnings) == 1
    assert loads.warnings[0].startswith("10 frames have a loaded plate with no foot within 0.20 m ")


def test_a_plate_recorded_only_partly_is_valid_only_there():
    q = on_the_right_foot(60)
    loads = assigned(q, [plate(ball(q[0], RIGHT), WEIGHT_N, 20, start_s=0.2)])
    recorded = np.arange(20, 40)
    assert loads.valid[recorded].all()
    assert not np.delete(loads.valid, recorded).any()
    np.testing.assert_array_equal(np.delete(loads.plate_wrench, recorded, axis=0), 0.0)


def test_a_raised_plate_has_its_pressure_on_its_own_surface():
    """r × F plus a free moment about the vertical is the whole moment."""
    q = np.repeat(standing(z=0.15)[None], 10, axis=0)
    loads = assigned(
        q, [plate(ball(q[0], side), 0.5 * WEIGHT_N, 10, height_m=0.15) for side in (RIGHT, LEFT)]
    )
    assert loads.valid.all()
    assert_near(loads.centre_of_pressure_m[..., 2], 0.15, 1e-15)
    force, moment = loads.wrench[..., :3], loads.wrench[..., 3:]
    free = loads.free_moment_nm[..., None] * [0, 0, 1]
    assert_near(np.cross(loads.centre_of_pressure_m, force) + free, moment, 1e-12)


def test_flight_is_fully_measured_and_single_support_too():
    time = np.arange(60) / RATE_HZ
    height = np.maximum(
        0.0, 2.0 * (time - 0.1) - GRAVITY_M_S2 / 2 * (time - 0.1) ** 2
    )  # off the floor for 0.41 s
    q = np.array([standing(z=z) for z in height])
    load = np.where(height > 0, 0.0, 0.5 * WEIGHT_N)
    loads = assigned(q, [plate(ball(q[0], side), load, 60) for side in (RIGHT, LEFT)])
    assert loads.valid[height > 0.03].all()
    assert loads.valid[:9].all()
    np.testing.assert_array_equal(loads.wrench[height > 0.03], 0.0)
    assert np.isnan(loads.centre_of_pressure_m[height > 0.03]).all()


def test_hanging_without_falling_is_not_flight():
    """The person holds on to a bar: no foot touches, no plate is loaded, and yet something carries the body."""
    rise = 0.1 * (1 - np.cos(np.linspace(0, np.pi, 60)))  # at most 2.8 m/s²
    height = np.r_[np.zeros(20), rise, np.full(30, 0.2)]
    q = np.array([standing(z=z) for z in height])
    load = np.where(height > 0, 0.0, 0.5 * WEIGHT_N)
    loads = assigned(q, [plate(ball(q[0], side), load, 110) for side in (RIGHT, LEFT)])
    assert loads.valid[:19].all()
    assert not loads.valid[45:].any()


def test_without_plates_nothing_is_measured():
    q = np.repeat(standing()[None], 5, axis=0)
    loads = assigned(q, [])
    assert not loads.valid.any()
    assert loads.warnings == ()
    assert loads.plate_wrench.shape == (5, 0, 6)
    np.testing.assert_array_equal(loads.wrench, 0.0)


def test_untracked_frames_assign_no_load():
    q = on_the_right_foot(30)
    at, lost = ball(q[0], RIGHT), np.arange(15, 22)
    q[lost] = np.nan
    loads = assigned(q, [plate(at, WEIGHT_N, 30)])
    assert (loads.foot_of_plate[lost] == NEITHER).all()
    assert (np.delete(loads.foot_of_plate, lost) == RIGHT).all()
    assert not loads.valid[lost].any()
    assert loads.valid[7:14].all()
    assert loads.valid[23:].all()


def test_feet_that_touch_beside_the_plates_are_unread():
    q = np.repeat(standing()[None], 20, axis=0)
    right = plate(ball(q[0], RIGHT), 0.5 * WEIGHT_N, 20)
    np.testing.assert_array_equal(assigned(q, [right]).unread, np.tile([False, True], (20, 1)))
    left = plate(ball(q[0], LEFT), 0.5 * WEIGHT_N, 20)
    assert not assigned(q, [right, left]).unread.any()
    assert assigned(q, []).unread.all()
    lifted = on_the_right_foot(60)
    loads = assigned(lifted, [plate(ball(lifted[-1], RIGHT), WEIGHT_N, 60)])
    assert not loads.unread[8:].any()


@pytest.mark.parametrize("height_m", [0.0, 0.3])
def test_the_floor_lies_where_the_soles_are_lowest(height_m):
    q = on_the_right_foot(60)
    q[:, 2] += height_m
    q[30:40] = np.nan
    assert assigned(q, []).floor_m == pytest.approx(height_m, abs=1e-9)
    assert np.isnan(assigned(np.full_like(q, np.nan), []).floor_m)


@pytest.mark.parametrize("outline", [True, False])
def test_a_foot_on_a_plate_that_fell_silent_is_not_fully_measured(outline):
    """Even one that rolls too fast to be taken for standing elsewhere; a foot high above it is none of its business."""
    frames = 30
    q = np.repeat(standing()[None], frames, axis=0)
    q[:, 0] += 0.006 * np.arange(frames)  # 0.6 m/s
    right, left = (plate(ball(q[15], side), 0.5 * WEIGHT_N, frames) for side in (RIGHT, LEFT))
    broken = right.force_n.copy()
    broken[100:200] = np.nan
    silent = replace(right, force_n=broken, corners_m=right.corners_m if outline else None)
    assert assigned(q, [right, left]).valid[12:18].all()
    assert not assigned(q, [silent, left]).valid[12:18].any()
    elsewhere = plate(np.array([5.0, 5.0]), 0.0, frames)
    gone = replace(elsewhere, force_n=np.full_like(elsewhere.force_n, np.nan))
    assert assigned(q, [right, left, gone]).valid[12:18].all()


def test_a_plate_that_fell_silent_does_not_matter_to_feet_that_share_another():
    """Both stand on one plate that reads; another was not recorded, and nobody can stand on it."""
    q = np.repeat(standing()[None], 20, axis=0)
    middle = 0.5 * (ball(q[0], RIGHT) + ball(q[0], LEFT))
    silent = replace(plate(ball(q[0], RIGHT), 0.0, 20, start_s=9.0), corners_m=None)
    assert assigned(q, [plate(middle, WEIGHT_N, 20, half_m=0.5), silent]).valid.all()
