"""Walking on a treadmill: the walk over ground in a frame that moves with it, and what plates under belts read."""

import numpy as np
import pytest

from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.synthesis.contact import sole_outline
from mbkf.synthesis.plates import BELT_M, on_belts
from mbkf.synthesis.treadmill import treadmill_plan
from mbkf.synthesis.walk import walk_and_speed

BELTS = {"belt_walk": 1, "split_belt_walk": 2}
EXACT = CaptureSettings(force_sd_n=0.0, moment_sd_nm=0.0, offset_n=(0.0, 0.0))


def test_feet_and_pressure_are_the_walk_s_but_for_uniform_motion(body):
    walk, speed_m_s = walk_and_speed(body, 3.0, np.random.default_rng(7))
    belt = treadmill_plan(body, 3.0, np.random.default_rng(7), belts=1)
    times = np.linspace(0.0, 3.0, 61)
    back = np.outer(times, [-speed_m_s, 0.0, 0.0])
    shift = belt.feet(times)["r"].ankle.value[0] - walk.feet(times)["r"].ankle.value[0]
    assert shift[1:] == pytest.approx([0.0, 0.0])
    for side, foot in walk.feet(times).items():
        moving = belt.feet(times)[side]
        assert np.allclose(moving.ankle.value, foot.ankle.value + back + shift)
        assert np.allclose(moving.ankle.first, foot.ankle.first - [speed_m_s, 0.0, 0.0])
        assert np.allclose(moving.ankle.second, foot.ankle.second)
    pressure = walk.load(times).pressure + (back + shift)[:, None, :2]
    assert np.allclose(belt.load(times).pressure, pressure)
    assert np.array_equal(belt.load(times).share, walk.load(times).share)


@pytest.mark.slow
@pytest.mark.parametrize("name", BELTS)
def test_the_walker_stays_while_flat_feet_travel_back_with_the_belt(body, motions, name):
    motion = motions[name]
    assert motion.belts == BELTS[name]
    assert np.abs(motion.q[:, 0]).max() < 0.1
    assert np.ptp(motion.q[:, 0]) < 0.05
    speeds = []
    for foot, side in enumerate(("right", "left")):
        joint = body.joint(f"{side}_foot").joint_id
        where = np.array([body.placements(q)[1][joint] for q in motion.q])
        turned = np.array([body.placements(q)[0][joint][2, 0] for q in motion.q])
        flat = (
            (motion.foot_wrench[:-1, foot, 2] > 0)
            & (np.abs(turned[:-1]) < 1e-9)
            & (np.abs(turned[1:]) < 1e-9)
        )
        assert flat.sum() > 10
        speeds.append(np.diff(where, axis=0)[flat] * motion.rate_hz)
    travelled = np.concatenate(speeds)
    assert np.abs(travelled - travelled[0]).max() < 1e-6
    assert -1.4 < travelled[0, 0] < -1.0
    assert np.abs(travelled[0, 1:]).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", BELTS)
def test_belts_read_the_feet_that_stand_on_them(person, motions, name):
    motion = motions[name]
    plates = synthesise_capture(person, motion, EXACT, seed=2).trial.plates
    assert len(plates) == BELTS[name]
    read = [np.hstack([p.force_n, p.moment_nm + np.cross(p.origin_m, p.force_n)]) for p in plates]
    feet = np.moveaxis(motion.plate_wrench, 1, 0)
    wanted = [feet.sum(axis=0)] if len(plates) == 1 else list(feet)
    assert np.abs(np.array(read) - np.array(wanted)).max() < 1e-9
    for plate in plates:
        pressed = plate.centre_of_pressure_m[~np.isnan(plate.centre_of_pressure_m[:, 0]), :2]
        low, high = plate.corners_m.min(axis=0)[:2], plate.corners_m.max(axis=0)[:2]
        assert ((pressed > low) & (pressed < high)).all()
    if len(plates) == 2:
        assert plates[0].corners_m[:, 1].max() < plates[1].corners_m[:, 1].min()


@pytest.mark.slow
def test_no_sole_reaches_over_the_other_belt(body, motions):
    motion = motions["split_belt_walk"]
    for side, name, sign in (("r", "right", -1.0), ("l", "left", 1.0)):
        outline, joint = sole_outline(body, side), body.joint(f"{name}_foot").joint_id
        corners = np.array(
            [
                [x, y, outline.height]
                for x in (outline.heel_x, outline.toe_x)
                for y in (outline.low_y, outline.high_y)
            ]
        )
        for q in motion.q:
            rotations, origins = body.placements(q)
            assert (sign * (origins[joint] + corners @ rotations[joint].T)[:, 1]).min() > 0.0


def test_belts_have_their_usual_size_or_reach_beyond_the_pressures():
    wrench, surface = np.zeros((4, 2, 6)), np.zeros((4, 2))
    for at, half in ((0.2, 0.5 * BELT_M[0]), (1.5, 1.6)):
        for foot, y in ((0, -0.1), (1, 0.1)):
            for k in range(4):
                force = np.array([0.0, 0.0, 500.0])
                wrench[k, foot] = np.r_[force, np.cross([at * (-1) ** k, y, 0.0], force)]
        ((whole, corners),) = on_belts(wrench, surface, 1)
        assert np.array_equal(whole, wrench.sum(axis=1))
        assert np.abs(corners[:, :2]).max(axis=0) == pytest.approx([half, BELT_M[1]])
        right, left = on_belts(wrench, surface, 2)
        assert right[1][:, 1].max() < 0.0 < left[1][:, 1].min()
