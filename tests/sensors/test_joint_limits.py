"""Soft joint limits: silent inside, a spring outside, for every axis of every joint."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.sensors.block import Notes
from mbkf.sensors.joint_limits import JointLimits, JointLimitSettings
from mbkf.sensors.posture_sensor import PostureSensor
from tests.dynamics import prepared_at, trial
from tests.motions import assert_near, reference_model

MODEL = reference_model()
NV = MODEL.nv
POSTURE = PostureSensor(MODEL)
SD = 0.03
FREE = np.zeros(NV, dtype=bool)
LIMITS = JointLimits(POSTURE, FREE, JointLimitSettings(SD))
KNEE = MODEL.joint("right_shank").v.stop - 1


def bent(dof, angle):
    q = MODEL.neutral()
    return MODEL.integrate(q, angle * np.eye(NV)[dof])


def at(q, limits=LIMITS):
    return limits.information(*POSTURE.deviation(q))


def test_every_joint_is_limited_on_both_sides_of_standing_and_the_pelvis_is_not():
    assert np.isinf(LIMITS.lower[:6]).all() and np.isinf(LIMITS.upper[:6]).all()
    limited = np.isfinite(LIMITS.lower[6:])
    assert limited.mean() > 0.9
    np.testing.assert_array_equal(limited, np.isfinite(LIMITS.upper[6:]))
    assert (LIMITS.lower[6:] < 0).all() and (LIMITS.upper[6:] > 0).all()


@pytest.mark.parametrize("name", ["squat", "walk", pytest.param("jump", marks=pytest.mark.slow)])
def test_people_who_move_pass_no_limit(name):
    made = trial(name)
    posture = PostureSensor(made.model)
    limits = JointLimits(posture, FREE, JointLimitSettings(SD))
    assert all(limits.information(*posture.deviation(q)) is None for q in made.motion.q)
    assert at(MODEL.neutral()) is None


SIDES = [
    (dof, side, limit)
    for side, limits in (("lower", LIMITS.lower), ("upper", LIMITS.upper))
    for dof, limit in enumerate(limits)
    if abs(limit) < np.pi - 0.1
]


@pytest.mark.parametrize(("dof", "side", "limit"), SIDES)
def test_a_passed_limit_reads_its_joint_at_the_limit(dof, side, limit):
    """One reading of the deviation itself: information 1/sd², innovation the way back."""
    beyond = 0.05 * np.sign(limit)
    found = at(bent(dof, limit + beyond))
    e = np.eye(NV)[dof]
    assert_near(found.matrix @ e, e / SD**2, 1e-6 / SD**2)
    assert_near(found.vector, -beyond / SD**2 * e, 1e-6 / SD**2)
    assert found.readings == 0 and found.innovation == 0.0


@pytest.mark.parametrize("degrees", [-170.0, -179.9, -180.1, -185.0])
@pytest.mark.parametrize("arm", ["right_upper_arm", "left_upper_arm"])
def test_an_arm_raised_past_the_vertical_is_not_pulled_down(arm, degrees):
    """A rotation vector ends at half a turn; beyond it the same arm looks as if swung far back."""
    raised = bent(MODEL.joint(arm).v.start + 1, np.deg2rad(degrees))
    assert at(raised) is None


def test_the_reading_begins_at_the_limit():
    limit = LIMITS.upper[KNEE] if abs(LIMITS.upper[KNEE]) < abs(LIMITS.lower[KNEE]) else LIMITS.lower[KNEE]
    assert at(bent(KNEE, limit - 1e-6 * np.sign(limit))) is None
    just = at(bent(KNEE, limit + 1e-6 * np.sign(limit)))
    assert 0 < np.abs(just.vector).max() < 1e-5 / SD**2


def test_unobservable_dofs_have_no_limits():
    unobservable = FREE.copy()
    unobservable[KNEE] = True
    assert at(bent(KNEE, 3.0), JointLimits(POSTURE, unobservable, JointLimitSettings(SD))) is None
    assert at(bent(KNEE, 3.0)) is not None


def test_a_passed_limit_is_read_whether_or_not_its_joint_is_observed():
    """It does not depend on the frame, and is at hand before it comes."""
    state = SimpleNamespace(q=bent(KNEE, 3.0))
    point = prepared_at(LIMITS, state)
    expected = at(state.q)
    assert LIMITS.linearise(point, LIMITS.decide(point, None, None, Notes())) is point.prepared
    np.testing.assert_array_equal(point.prepared.matrix, expected.matrix)
    np.testing.assert_array_equal(point.prepared.vector, expected.vector)
