"""Shoulders of trials: displaced alike in the frames of a trial, expected as its arms are raised."""

import numpy as np

from mbkf.model.protocol import load_protocol
from mbkf.scaling.records import ScalingPrior
from mbkf.scaling.shoulders import TrialShoulders, without_shoulders
from mbkf.sensors.shoulder_girdle import ShoulderGirdle, girdle_prior
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
MARKERS = load_protocol("reference36").markers
GIRDLE = ShoulderGirdle(MODEL, [m.segment for m in MARKERS], np.array([m.position_m for m in MARKERS]))
TRIAL = np.array([0, 0, 1])
RNG = np.random.default_rng(0)


def test_frames_of_a_trial_share_its_displacements_and_markers_follow_by_their_share():
    shoulders, displaced, trunks = TrialShoulders(GIRDLE, TRIAL), RNG.normal(size=(2, 2, 3)), np.eye(3)
    found = shoulders.displaced_m(displaced.ravel())
    np.testing.assert_array_equal(found, displaced[TRIAL])
    derivative = shoulders.by_displacements(np.broadcast_to(trunks, (3, 2, 3, 3)))
    moved = np.einsum("mg,ngi->nmi", GIRDLE.carried, found)
    np.testing.assert_allclose(derivative @ displaced.ravel(), moved, atol=1e-15)
    np.testing.assert_array_equal(
        shoulders.of_frames(np.array([2])).displaced_m(displaced.ravel()), found[2:]
    )
    assert shoulders.displaced_m(np.zeros(0)) is None


def test_displacements_are_expected_by_the_mean_elevation_of_a_trial():
    poses = np.array([moderate_pose(MODEL, RNG) for _ in TRIAL])
    poses[0, MODEL.joint("right_upper_arm").q] = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
    prior = ScalingPrior(np.ones(2), np.eye(2), np.zeros((1, 3)), np.eye(3))
    found = TrialShoulders(GIRDLE, TRIAL).expected(prior, MODEL.description, poses)
    raised = GIRDLE.raised(poses)
    mean, covariance = girdle_prior(MODEL.description, np.array([raised[:2].mean(axis=0), raised[2]]))
    np.testing.assert_allclose(found.girdle_m, mean, atol=1e-15)
    np.testing.assert_allclose(found.girdle_covariance, covariance, atol=1e-15)
    information = np.linalg.inv(np.diag(np.arange(1.0, 2 + 12 + 3 + 1)))
    others = np.diag(np.r_[1.0, 2.0, 15.0, 16.0, 17.0])
    np.testing.assert_allclose(np.linalg.inv(without_shoulders(information, found, 2)), others, rtol=1e-12)


def test_shoulders_are_displaced_in_trials_with_raised_arms_alone():
    """A trial with hanging arms places the shoulders; after a scaling with raised arms none has placed them."""
    hanging, raised = MODEL.neutral(), MODEL.neutral()
    raised[MODEL.joint("left_upper_arm").q] = [np.sin(0.5), 0.0, 0.0, np.cos(0.5)]
    prior = ScalingPrior(np.ones(2), np.eye(2), np.zeros((1, 3)), np.eye(3))
    low, high = np.array([hanging] * 3), np.array([hanging, hanging, raised])

    def free(poses, standing=None):
        shoulders = TrialShoulders(GIRDLE, TRIAL).raised(poses, standing)
        return shoulders.expected(prior, MODEL.description, poses)

    assert (free(low).raised, free(low, hanging).raised, free(low, raised).raised) == (0, 0, 12)
    found = free(high)
    mean, covariance = girdle_prior(MODEL.description, GIRDLE.raised(high[2:]))
    np.testing.assert_allclose(found.girdle_m, mean, atol=1e-15)
    np.testing.assert_allclose(found.girdle_covariance, covariance, atol=1e-15)
    shoulders = TrialShoulders(GIRDLE, TRIAL).raised(high)
    displaced = shoulders.displaced_m(np.arange(6.0))
    np.testing.assert_array_equal(displaced[:2], np.zeros((2, 2, 3)))
    np.testing.assert_array_equal(displaced[2].ravel(), np.arange(6.0))
