"""The markers any filter expects: where steady motion takes them, as sure as the filter's own prediction."""

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import KinematicFollower
from mbkf.filters.prediction import expected_markers
from mbkf.filters.settings import KinematicSettings
from tests.labelling.bodies import posture, reference_sensor

SENSOR = reference_sensor()
DT = 0.01


def followed(frames=12):
    """A follower and its estimate of a body that moves forward at 1 m/s."""
    model = SENSOR.model
    q = posture(model, np.random.default_rng(0), 0.1)
    markers = np.array([SENSOR.positions(q) + np.array([k * DT, 0.0, 0.0]) for k in range(frames)])
    recording = Recording(markers, np.zeros((frames, 0, 6)), DT)
    noise = np.full(len(SENSOR.segments), 0.005)
    held = np.zeros(model.nv, dtype=bool)
    follower = KinematicFollower(KinematicFilter(SENSOR, noise, DT, held, KinematicSettings()))
    estimate = follower.start(recording, 0, None)
    for t in range(1, frames):
        estimate = follower.step(estimate, recording, t)
    return follower, estimate, markers[-1]


def test_markers_are_expected_where_the_body_goes():
    follower, estimate, last = followed()
    expected = expected_markers(follower, estimate, SENSOR)
    assert np.abs(expected.positions_m - (last + np.array([DT, 0.0, 0.0]))).max() < 0.003


def test_covariance_is_the_kinematic_plants_own():
    """Up to the retraction's curvature, which one step hardly has."""
    follower, estimate, _ = followed()
    nv = SENSOR.model.nv
    ours = expected_markers(follower, estimate, SENSOR).covariance
    theirs = follower.kalman.plant.predict(estimate.inner.state).P[:nv, :nv]
    assert np.allclose(ours, theirs, atol=2e-2 * np.abs(theirs).max())
    assert np.allclose(ours, ours.T)
    assert np.linalg.eigvalsh(ours).min() > 0.0
