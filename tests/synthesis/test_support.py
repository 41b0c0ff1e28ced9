"""Motions on more than the feet: Newton and Euler with every contact, the laws of contact, and parts that stay put."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, SIDES
from mbkf.errors import InvalidInput
from mbkf.synthesis.contact import FRICTION, Load, sole_outline
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.synthesis.support import SEGMENTS, Support, fault, wrenches, zero_moment

SHORT_S = {"sit_to_stand": 2.6, "rail": 3.0, "kneel": 6.8}
SEEDS = (1, 2, 3)
KNEEL_SEEDS = (1, 3)
MADE = [(name, seed) for name in SHORT_S for seed in (KNEEL_SEEDS if name == "kneel" else SEEDS)]


@pytest.fixture(scope="module", params=MADE, ids=str)
def supported(request):
    """A body and its motion, another person for every seed."""
    name, seed = request.param
    body = body_of(synthesise_subject(seed))
    return body, synthesise_motion(body, name, SHORT_S[name], seed=seed)


def constant(value):
    return lambda times: np.tile(np.asarray(value, dtype=float), (len(times), 1))


def seat(share):
    return Support("pelvis", lambda times: np.full(len(times), share), constant([-0.3, 0.02, 0.45]))


RAIL = Support(
    "right_hand",
    lambda times: np.zeros(len(times)),
    constant([0.4, -0.3, 1.0]),
    constant([-30.0, 10.0, 60.0]),
    held=True,
)


def test_feet_and_supports_have_the_moment_of_the_whole_force_at_the_point_of_zero_moment():
    times, height, whole = np.zeros(1), np.array([0.7]), np.array([[25.0, -12.0, 700.0]])
    pressure = np.array([[[0.05, -0.1], [0.02, 0.12]]])
    load = Load(np.array([0.4]), pressure, np.array([True]))
    parts = (seat(0.6), RAIL)
    point, level = zero_moment(parts, times, load, height, whole[:, 2])
    carried = wrenches(parts, times, whole).sum(axis=1)[0]
    rest = whole[0] - carried[:3]
    below = np.array([*load.total_pressure[0], 0.0])
    moment = carried[3:] + np.cross(below, rest)
    about = moment - np.cross([*point[0], 0.0], whole[0])
    lifted = np.cross([0.0, 0.0, level[0]], whole[0])
    assert np.abs((about - lifted)[:2]).max() < 1e-9


def test_what_is_not_held_pushes_within_friction():
    force = np.array([[0.0, 0.0, 5.0, 0, 0, 0], [3.0, 0.0, 5.0, 0, 0, 0]])[:, None]
    assert fault((seat(0.5),), force) == ""
    assert "slip" in fault((seat(0.5),), force * [4.0, 1, 1, 1, 1, 1])
    assert "pulled" in fault((seat(0.5),), -force)
    assert fault((RAIL,), -force) == ""


def test_a_share_that_is_almost_none_is_none():
    assert not wrenches((seat(1e-12),), np.zeros(3), np.full((3, 3), 700.0)).any()


@pytest.mark.slow
def test_the_root_s_equations_vanish_with_all_contacts(supported):
    body, motion = supported
    names = [f"{SIDE_NAMES[side]}_foot" for side in SIDES] + [SEGMENTS[n] for n in motion.support_names]
    every = np.concatenate([motion.foot_wrench, motion.support_wrench], axis=1)
    for k in range(len(motion.q)):
        rest = body.inverse_dynamics(motion.q[k], motion.v[k], motion.a[k])
        for name, wrench in zip(names, every[k], strict=True):
            rest = rest - body.segment_jacobian(motion.q[k], name, np.zeros(3)).T @ wrench
        assert np.abs(rest - motion.tau[k]).max() < 1e-9
        assert np.abs(rest[:6]).max() < 1e-9 * body.mass_kg * GRAVITY_M_S2


@pytest.mark.slow
def test_supports_and_feet_push_within_friction(supported):
    _, motion = supported
    held = [name.endswith("hand") and motion.name == "rail" for name in motion.support_names]
    pushing = motion.support_wrench[:, ~np.array(held)]
    for wrench in (pushing, motion.foot_wrench):
        assert (wrench[..., 2] >= 0).all()
        assert (np.linalg.norm(wrench[..., :2], axis=-1) <= FRICTION * wrench[..., 2] + 1e-9).all()


@pytest.mark.slow
def test_pressure_stays_under_the_soles(supported):
    body, motion = supported
    for foot, side in enumerate(SIDES):
        outline, joint = sole_outline(body, side), body.joint(f"{SIDE_NAMES[side]}_foot").joint_id
        for k in np.flatnonzero(motion.foot_wrench[:, foot, 2] > 0):
            rotations, origins = body.placements(motion.q[k])
            assert outline.holds(rotations[joint].T @ (motion.centre_of_pressure[k, foot] - origins[joint]))


@pytest.mark.slow
def test_contact_begins_or_ends_within_the_trial_and_is_smooth(supported):
    body, motion = supported
    for k in range(len(motion.support_names)):
        force = motion.support_wrench[:, k, :3]
        bears = np.linalg.norm(force, axis=1) > 0
        assert 0.1 < bears.mean() < 0.9
        assert not motion.support_wrench[~bears, k].any()
        jump = np.abs(np.diff(force, axis=0)).max() * motion.rate_hz
        assert jump < 12.0 * body.mass_kg * GRAVITY_M_S2


def hips(body, q):
    """(3,) middle of the hips."""
    origins = body.placements(q)[1]
    return 0.5 * sum(origins[body.joint(f"{side}_thigh").joint_id] for side in SIDE_NAMES.values())


@pytest.mark.slow
@pytest.mark.parametrize("supported", [("sit_to_stand", 1)], indirect=True)
def test_who_sits_stays_on_the_seat_and_then_stands(supported):
    body, motion = supported
    weight = body.mass_kg * GRAVITY_M_S2
    share = motion.support_wrench[:, 0, 2] / weight
    assert 0.7 < share[0] < 0.9
    middle = np.array([hips(body, q) for q in motion.q])
    firm = share > 0.5
    assert np.ptp(middle[firm], axis=0).max() < 0.02
    point = np.cross(motion.support_wrench[firm, 0, :3], motion.support_wrench[firm, 0, 3:])
    along = motion.support_wrench[firm, 0, :3]
    line = point / (along**2).sum(axis=1)[:, None]
    pressed = line + along * ((middle[firm, 2] - 0.1 - line[:, 2]) / along[:, 2])[:, None]
    assert np.abs((pressed - middle[firm])[:, :2]).max() < 0.05
    assert middle[-1, 2] - middle[0, 2] > 0.3
    assert motion.foot_wrench[-1, :, 2].sum() > 0.9 * weight


def test_standing_up_needs_time():
    with pytest.raises(InvalidInput, match="standing up"):
        synthesise_motion(body_of(synthesise_subject(1)), "sit_to_stand", 1.5)


@pytest.mark.slow
@pytest.mark.parametrize("supported", [("rail", seed) for seed in SEEDS], indirect=True)
def test_a_hand_that_holds_a_rail_stays_where_it_is(supported):
    body, motion = supported
    (name,) = motion.support_names
    joint = body.joint(SEGMENTS[name]).joint_id
    force = np.linalg.norm(motion.support_wrench[:, 0, :3], axis=1)
    holds = force > 0
    placed = [body.placements(q) for q in motion.q[holds]]
    where = np.array([origins[joint] for _, origins in placed])
    assert np.ptp(where, axis=0).max() < 1e-9
    assert np.ptp([rotations[joint] for rotations, _ in placed], axis=0).max() < 1e-9
    assert 0.1 <= force.max() / (body.mass_kg * GRAVITY_M_S2) <= 0.2
    rested = body.placements(motion.q[0])[1][joint]
    assert np.linalg.norm(where[0] - rested) > 0.2
    moment, pushed = motion.support_wrench[holds, 0, 3:], motion.support_wrench[holds, 0, :3]
    lever = moment - np.cross(where, pushed)
    assert (np.linalg.norm(lever, axis=1) <= 0.08 * force[holds]).all()


@pytest.mark.slow
@pytest.mark.parametrize("supported", [("kneel", seed) for seed in KNEEL_SEEDS], indirect=True)
def test_who_kneels_rests_on_knee_and_fingertips(supported):
    body, motion = supported
    weight = body.mass_kg * GRAVITY_M_S2
    side = motion.support_names[0].removesuffix("_knee")
    assert motion.support_names == (f"{side}_knee", f"{side}_hand")
    knee, hand = (motion.support_wrench[:, k, 2] > 0 for k in range(2))
    assert (knee | ~hand).all()
    origins = np.array([body.placements(q)[1] for q in motion.q])
    at_knee, at_wrist = (origins[:, body.joint(f"{side}_{part}").joint_id] for part in ("shank", "hand"))
    assert np.ptp(at_knee[knee], axis=0).max() < 0.003
    assert at_knee[:, 2].min() > at_knee[knee, 2].min() - 0.002
    assert at_knee[0, 2] - at_knee[knee, 2].mean() > 0.25
    assert np.ptp(at_wrist[hand], axis=0).max() < 1e-9
    assert at_wrist[hand, 2].mean() < 0.2
    for k, bears, above in ((0, knee, at_knee), (1, hand, at_wrist)):
        force, moment = motion.support_wrench[bears, k, :3], motion.support_wrench[bears, k, 3:]
        pressed = np.column_stack([-moment[:, 1], moment[:, 0]]) / force[:, 2:]
        assert np.abs(pressed - above[bears, :2]).max() < 0.01
    share = motion.support_wrench[:, :, 2].max(axis=0) / weight
    assert 0.4 < share[0] < 0.7
    assert 0.08 < share[1] < 0.2
    rear = motion.foot_wrench[:, 0 if side == "right" else 1, 2]
    assert rear[hand].max() < 0.12 * weight


@pytest.mark.slow
@pytest.mark.parametrize("supported", MADE[3:], indirect=True)
def test_joints_stay_within_their_limits(supported):
    body, motion = supported
    for side in ("right", "left"):
        for part in ("upper_arm", "forearm", "hand", "thigh", "shank", "foot"):
            joint = body.joint(f"{side}_{part}")
            turned = Rotation.from_quat(motion.q[:, joint.q]).as_euler("YXZ", degrees=True)[:, [1, 0, 2]]
            low, high = np.rad2deg(body.limits[joint.v]).T
            assert ((turned >= low) & (turned <= high)).all(), f"{side}_{part}"
