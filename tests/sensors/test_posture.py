"""The posture prior: what it calls deviation, and for which dofs."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.numerics.kalman import information
from mbkf.sensors.posture import PosturePrior, PostureSettings, posture_information
from mbkf.sensors.posture_sensor import PostureSensor
from tests.dynamics import notes_of, prepared_at
from tests.motions import assert_near, moderate_pose, reference_model, worst

MODEL = reference_model()
SENSOR = PostureSensor(MODEL)


def test_standing_straight_is_no_deviation():
    np.testing.assert_array_equal(SENSOR.reading(MODEL.neutral()).deviation, 0.0)


def test_all_joints_have_a_prior_and_the_pelvis_has_none():
    np.testing.assert_array_equal(SENSOR.dofs, np.arange(6, MODEL.nv))
    np.testing.assert_array_equal(SENSOR.sd, MODEL.posture_sd[6:])
    assert (SENSOR.sd > 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_deviation_is_each_joints_rotation_vector(seed):
    q = moderate_pose(MODEL, np.random.default_rng(seed))
    deviation = np.zeros(MODEL.nv)
    deviation[SENSOR.dofs] = SENSOR.reading(q).deviation
    for joint in MODEL.joints.values():
        if joint.kind == "spherical":
            assert_near(deviation[joint.v], Rotation.from_quat(q[joint.q]).as_rotvec(), 1e-15)
        elif joint.kind != "free":
            np.testing.assert_array_equal(deviation[joint.v], q[joint.q])


def test_each_joint_deviates_by_itself():
    """The Jacobian is block-diagonal over joints and blind to the pelvis."""
    jacobian = SENSOR.reading(moderate_pose(MODEL, np.random.default_rng(4))).jacobian
    owner = np.concatenate([np.full(j.v.stop - j.v.start, i) for i, j in enumerate(MODEL.joints.values())])
    same_joint = owner[SENSOR.dofs][:, None] == owner
    universal = MODEL.joint("neck").v
    same_joint[np.ix_(np.isin(SENSOR.dofs, [universal.start]), [universal.start + 1])] = False
    same_joint[np.ix_(np.isin(SENSOR.dofs, [universal.start + 1]), [universal.start])] = False
    np.testing.assert_array_equal(jacobian != 0, same_joint)


def test_where_and_how_the_body_stands_does_not_matter():
    rng = np.random.default_rng(5)
    q = moderate_pose(MODEL, rng)
    elsewhere = MODEL.integrate(q, np.concatenate([rng.normal(size=6), np.zeros(MODEL.nv - 6)]))
    np.testing.assert_array_equal(SENSOR.reading(elsewhere).deviation, SENSOR.reading(q).deviation)


def test_the_prior_is_the_information_of_the_stacked_readings():
    """Unobservable dofs have no reading; each deviation is read as zero."""
    q = moderate_pose(MODEL, np.random.default_rng(6))
    unobservable = np.arange(MODEL.nv) % 7 == 0
    found = posture_information(*SENSOR.deviation(q), SENSOR.weights(10.0, unobservable))
    reading, free = SENSOR.reading(q), np.flatnonzero(~unobservable[SENSOR.dofs])
    stacked = information(-reading.deviation[free], reading.jacobian[free], 10.0 * SENSOR.sd[free])
    assert_near(found.matrix, stacked.matrix, 1e-14)
    assert_near(found.vector, stacked.vector, 1e-14)
    assert found.readings == 0


def test_a_body_on_its_head_is_read_like_one_on_its_feet():
    """The pelvis may be turned by π, where its own rotation vector has no derivative."""
    q = moderate_pose(MODEL, np.random.default_rng(7))
    upside_down = q.copy()
    upside_down[3:7] = [1.0, 0.0, 0.0, 0.0]
    np.testing.assert_array_equal(SENSOR.reading(upside_down).jacobian, SENSOR.reading(q).jacobian)


def prior_at(q, unobserved=(), **settings):
    """What the prior says at a posture while some dofs are unobserved, and what it had prepared."""
    block = PosturePrior(SENSOR, np.zeros(MODEL.nv, dtype=bool), PostureSettings(**settings))
    at = prepared_at(block, SimpleNamespace(q=q))
    return block.linearise(at, notes_of(unobserved=np.array(unobserved, dtype=np.intp))), at.prepared


def test_while_all_is_observed_the_prior_is_as_prepared():
    q = moderate_pose(MODEL, np.random.default_rng(8))
    found, prepared = prior_at(q, posture_scale=2.0, unseen_posture=3.0)
    assert found is prepared.information
    weights = SENSOR.weights(2.0, np.zeros(MODEL.nv, dtype=bool))
    expected = posture_information(*SENSOR.deviation(q), weights)
    assert_near(found.matrix, expected.matrix, 1e-14 * worst(expected.matrix))
    assert_near(found.vector, expected.vector, 1e-14 * worst(expected.vector))


def test_what_nothing_observes_has_a_prior_of_its_own_weight():
    q = moderate_pose(MODEL, np.random.default_rng(8))
    hidden = np.arange(*MODEL.joint("right_forearm").v.indices(MODEL.nv))
    found, prepared = prior_at(q, hidden, unseen_posture=3.0)
    weights = SENSOR.weights(1.0, np.zeros(MODEL.nv, dtype=bool))
    weights[hidden] *= 3.0
    expected = posture_information(*SENSOR.deviation(q), weights)
    assert_near(found.matrix, expected.matrix, 1e-14 * worst(expected.matrix))
    assert_near(found.vector, expected.vector, 1e-14 * worst(expected.vector))
    assert np.abs(found.matrix - prepared.information.matrix).max() > 0.0
