"""The pose of one frame of markers: exact poses come back, whatever way the body faces and whatever is missing."""

import numpy as np
import pytest

from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_most_markers, fit_pose, joint_by_joint, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_model, reference_model, worst

FAINT = 1e-6
"""Marker noise, m, against which the posture prior weighs nothing."""


def noise(sensor, value=FAINT):
    return np.full(len(sensor.segments), value)


def fitted(sensor, measured, start=None, **options):
    q = segment_by_segment(sensor, measured) if start is None else start
    return fit_pose(sensor, PostureSensor(sensor.model), measured, noise(sensor), q, **options)


def pose_error(model, q, truth):
    return worst(model.difference(truth, q))


@pytest.fixture
def body():
    model = random_model(np.random.default_rng(2))
    return model, *protocol_sensor(model)


@pytest.mark.parametrize("seed", range(8))
def test_a_moderate_pose_is_recovered_from_exact_markers(body, seed):
    model, sensor, _ = body
    truth = moderate_pose(model, np.random.default_rng(seed))
    found = fitted(sensor, sensor.positions(truth))
    assert found.converged
    assert pose_error(model, found.q, truth) < 1e-6
    assert found.rms_m < 1e-8


@pytest.mark.parametrize("heading", np.linspace(-np.pi, np.pi, 9))
def test_the_body_may_face_anywhere(body, heading):
    model, sensor, _ = body
    truth = moderate_pose(model, np.random.default_rng(1), spread=0.3, heading=heading)
    measured = sensor.positions(truth)
    assert worst(model.difference(truth, segment_by_segment(sensor, measured))[3:6]) < 0.2
    assert pose_error(model, fitted(sensor, measured).q, truth) < 1e-6


def test_a_limb_is_turned_by_its_own_markers_and_the_rest_stays(body):
    """A hip turned back to front comes back from exact markers, whatever it was; no other joint moves."""
    model, sensor, _ = body
    truth = moderate_pose(model, np.random.default_rng(4))
    balls = (joint for joint in model.joints.values() if joint.kind == "spherical")
    ball = max(balls, key=lambda joint: sensor.segments.count(joint.segment))
    assert sensor.segments.count(ball.segment) >= 3
    wrong = truth.copy()
    wrong[ball.q] = [0.0, 0.0, 1.0, 0.0]
    found = joint_by_joint(sensor, sensor.positions(truth), wrong, [ball])
    assert pose_error(model, found, truth) < 0.05
    others = np.ones(len(truth), bool)
    others[ball.q] = False
    assert_near(found[others], wrong[others], 0.0)


def test_the_fit_turns_with_the_markers(body):
    """Rotating all markers about the vertical rotates the pelvis and leaves the joints."""
    model, sensor, _ = body
    measured = sensor.positions(moderate_pose(model, np.random.default_rng(3), heading=0.4))
    c, s = np.cos(2.1), np.sin(2.1)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    here, there = (fitted(sensor, m).q for m in (measured, measured @ turn.T))
    assert_near(there[:3], turn @ here[:3], 1e-12)
    assert_near(there[7:], here[7:], 1e-13)


def test_missing_markers_of_a_well_covered_segment_do_not_matter(body):
    model, sensor, names = body
    truth = moderate_pose(model, np.random.default_rng(4))
    measured = sensor.positions(truth)
    for name in ("RASI", "RTHI", "LKNE", "RMID", "CLAV"):
        measured[names.index(name)] = np.nan
    found = fitted(sensor, measured)
    assert found.rms_m < 1e-5
    moving = ~np.isin(np.arange(model.nv), np.r_[model.joint("right_thigh").v, model.joint("left_thigh").v])
    assert worst(model.difference(truth, found.q)[moving]) < 0.2
    assert np.isfinite(found.covariance).all()


def test_unseen_joints_stay_neutral_with_the_priors_spread(body):
    model, sensor, _ = body
    truth = moderate_pose(model, np.random.default_rng(5))
    measured = sensor.positions(truth)
    for i, segment in enumerate(sensor.segments):
        if segment in ("right_upper_arm", "right_forearm", "right_hand"):
            measured[i] = np.nan
    found = fitted(sensor, measured)
    for segment in ("right_upper_arm", "right_forearm", "right_hand"):
        joint = model.joint(segment)
        assert_near(found.q[joint.q], [0, 0, 0, 1], 1e-12)
        assert_near(np.sqrt(np.diag(found.covariance))[joint.v], model.posture_sd[joint.v], 1e-8)


def test_no_markers_at_all_give_the_neutral_pose(body):
    model, sensor, names = body
    measured = np.full((len(names), 3), np.nan)
    np.testing.assert_array_equal(segment_by_segment(sensor, measured), model.neutral())
    found = fitted(sensor, measured)
    assert found.rms_m == np.inf
    assert_near(found.q, model.neutral(), 1e-15)


def test_covariance_is_the_inverse_of_the_information(body):
    """Markers with noise σ and priors: P⁻¹ = HᵀH/σ² + BᵀB/sd² at the fitted pose."""
    model, sensor, _ = body
    posture = PostureSensor(model)
    measured = sensor.positions(moderate_pose(model, np.random.default_rng(6)))
    found = fit_pose(sensor, posture, measured, noise(sensor, 0.005), segment_by_segment(sensor, measured))
    H = sensor.reading(found.q).jacobian.reshape(-1, model.nv) / 0.005
    B = posture.reading(found.q).jacobian / posture.sd[:, None]
    expected = H.T @ H + B.T @ B
    # Metres and radians on a common scale: an inverse is rounded by the size of its rows and columns.
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert (np.abs(np.linalg.inv(found.covariance) - expected) <= 2e-11 * scale).all()


def test_scatter_of_fits_is_what_the_covariance_says():
    """Poses fitted to noisy markers scatter with the stated covariance (pelvis only: 5 rigid markers, 6 dofs)."""
    model, rng, sigma = reference_model(), np.random.default_rng(7), 0.003
    local = np.array(
        [[0.1, 0.1, -0.2], [0.1, -0.1, -0.2], [-0.1, 0.05, -0.18], [-0.1, -0.05, -0.18], [0, 0.15, -0.1]]
    )
    sensor, posture = MarkerSensor(model, ["pelvis"] * 5, local), PostureSensor(model)
    truth, squared = moderate_pose(model, rng, spread=0.0), []
    exact = sensor.positions(truth)
    for _ in range(60):
        measured = exact + sigma * rng.normal(size=exact.shape)
        found = fit_pose(
            sensor, posture, measured, noise(sensor, sigma), segment_by_segment(sensor, measured)
        )
        error = model.difference(found.q, truth)[:6]
        squared.append(error @ np.linalg.solve(found.covariance[:6, :6], error))
    assert 0.75 < np.mean(squared) / 6 < 1.3  # 360 degrees of freedom: 1 ± 0.075


def test_running_out_of_iterations_is_reported(body):
    model, sensor, _ = body
    measured = sensor.positions(moderate_pose(model, np.random.default_rng(8)))
    assert not fitted(sensor, measured, start=model.neutral(), max_iterations=1).converged


@pytest.mark.parametrize("seed", range(6))
def test_stray_markers_are_left_out(body, seed):
    """One to three markers a foot off: where their segments show others, the pose is as good as without them."""
    model, sensor, names = body
    rng = np.random.default_rng(seed)
    truth = moderate_pose(model, rng, spread=0.4)
    measured = sensor.positions(truth) + 0.002 * rng.normal(size=(len(names), 3))
    strays = rng.choice(
        [names.index(name) for name in ("C7", "CLAV", "RASI", "LMID", "RMT1")], 1 + seed % 3, False
    )
    without = measured.copy()
    without[strays] = np.nan
    measured[strays] += 0.3 * rng.normal(size=(len(strays), 3)) + 0.2
    posture, sd = PostureSensor(model), noise(sensor, 0.005)
    found = fit_most_markers(sensor, posture, measured, sd, segment_by_segment(sensor, measured))
    alone = fit_pose(sensor, posture, without, sd, segment_by_segment(sensor, without))
    assert pose_error(model, found.q, alone.q) < 0.02
    assert found.rms_m < 0.01


def test_points_that_are_no_body_do_not_become_one(body):
    model, sensor, _ = body
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (len(sensor.segments), 3))
    start = segment_by_segment(sensor, points)
    assert fit_most_markers(sensor, PostureSensor(model), points, noise(sensor, 0.005), start).rms_m > 0.1


def test_many_frames_are_each_frame_by_itself(body):
    """Also where markers are missing, all of a frame's among them."""
    model, sensor, _ = body
    rng = np.random.default_rng(11)
    measured = np.array([sensor.positions(moderate_pose(model, rng)) for _ in range(6)])
    measured[rng.random(measured.shape[:2]) < 0.3] = np.nan
    measured[3] = np.nan
    found = segment_by_segment(sensor, measured)
    assert_near(found, [segment_by_segment(sensor, frame) for frame in measured], 1e-12)
    np.testing.assert_array_equal(found[3], model.neutral())
    assert segment_by_segment(sensor, measured[:0]).shape == (0, model.nq)
