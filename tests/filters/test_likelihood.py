"""The likelihood of a frame is the density of its stacked innovations, for both filters, whatever is missing."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.likelihood import step_likelihood, trial_likelihood
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.foot_contact import FootContact
from mbkf.sensors.markers import MarkerMemory, Markers
from tests.dynamics import DT, block_of, dynamic_filter, half_weight, random_state, standing, with_memory
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
NV = MODEL.nv
EVERYWHERE = np.zeros(NV, dtype=bool)


def dense(H, P, sd, y):
    """Log density of all innovations together; each in its own unit, or their covariance looks singular."""
    S = H @ P @ H.T + np.diag(sd**2)
    unit = np.sqrt(np.diag(S))
    return (
        multivariate_normal(np.zeros(len(y)), S / unit[:, None] / unit).logpdf(y / unit) - np.log(unit).sum()
    )


def marker_part(kalman, prior, seen, markers_m, sd):
    """Jacobian on q, standard deviations and innovations of the markers seen."""
    reading = kalman.sensor.reading(prior.q)
    jacobian = reading.jacobian[seen].reshape(-1, NV)
    return jacobian, np.repeat(sd[seen], 3), (markers_m - reading.positions_m)[seen].ravel()


@pytest.mark.parametrize("missing", [(), (0, 7, 20)], ids=["all", "some missing"])
def test_a_step_of_the_dynamic_filter(missing):
    rng = np.random.default_rng(2)
    kalman = dynamic_filter(MODEL, 2, plate_force_n=4.0, residual_moment_nm=0.7)
    state = random_state(MODEL, rng, standing(MODEL), 0.1)
    markers = kalman.sensor.positions(state.q) + 0.003 * rng.normal(size=(36, 3))
    markers[list(missing)] = np.nan
    detector = block_of(kalman, FootContact)[0].detector
    points = detector.decide(detector.begin(), state.q, state.v, state.a, np.zeros((2, 6))).centres_m
    memory = with_memory(kalman, Markers, kalman.begin(), MarkerMemory(1.7, None))
    step = kalman.step(state, memory, Frame(markers, half_weight(MODEL, points)))
    assert step.decisions.notes.contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    prior, s, seen = step.prior.state, kalman.settings, step.decisions.notes.trusted
    H, sd, y = marker_part(kalman, prior, seen, markers, kalman.noise_m * 1.7**0.5)
    rest = np.repeat([s.law.residual_force_n, s.law.residual_moment_nm], 3)
    rest = np.concatenate(
        [rest, np.tile(np.repeat([s.contact.plate_force_n, s.contact.plate_moment_nm], 3), 2)]
    )
    # Newton's law and plates; the rows between are the decay of the residual, a prior
    read = np.r_[0:6, 12:24]
    rows, values = step.readings.rows[read], step.readings.values[read]
    whole = np.zeros((len(H) + 18, len(prior.P)))
    whole[: len(H), :NV], whole[len(H) :] = H, rows * rest[:, None]
    expected = dense(whole, prior.P, np.concatenate([sd, rest]), np.concatenate([y, values * rest]))
    found, others = step_likelihood(kalman, step)
    assert others == 18
    assert sum(found) == pytest.approx(expected, rel=1e-5)
    alone = dense(H, prior.P[:NV, :NV], sd, y)
    assert found.readings == pytest.approx(alone, rel=1e-5)


@pytest.fixture(scope="module")
def recording():
    markers = marker_positions(
        protocol_sensor(MODEL)[0], smooth_motion(MODEL, np.random.default_rng(1)).frames(40, 1 / DT)[0]
    )
    markers += 0.002 * np.random.default_rng(0).normal(size=markers.shape)
    markers[:2] = np.nan
    markers[20, 3:6] = np.nan
    markers[25, 7] += 0.5
    return Recording(markers, np.zeros((40, 0, 6)), DT)


@pytest.fixture(scope="module")
def kinematic():
    sensor = protocol_sensor(MODEL)[0]
    kalman = KinematicFilter(sensor, np.full(36, 0.004), DT, EVERYWHERE, KinematicSettings())
    return TrackingFilter(KinematicReport(kalman), WarmStart(kalman))


def test_frames_of_the_kinematic_filter(kinematic, recording):
    found = trial_likelihood(kinematic, recording)
    assert found.first == 2
    np.testing.assert_array_equal(found.load_readings, 0)
    np.testing.assert_array_equal(
        found.marker_readings, 3 * (~np.isnan(recording.markers_m[:, :, 0])).sum(axis=1)
    )
    for t, estimate, _ in followed(TrackingLoop(kinematic), recording):
        if t not in (20, 25, 39):
            continue
        prior = estimate.record.step.prior.state
        seen = ~np.isnan(recording.markers_m[t, :, 0]) & ~estimate.refused
        assert estimate.refused.sum() == (t == 25)
        H, sd, y = marker_part(
            kinematic.kalman, prior, seen, recording.markers_m[t], kinematic.kalman.noise_m
        )
        expected = dense(H, prior.P[:NV, :NV], sd, y)
        assert found.markers[t] == pytest.approx(expected, rel=1e-5)


def test_a_refused_marker_counts_as_an_outlier(kinematic, recording):
    """It is worth less than a believed one, so that refusing does not pay."""
    found = trial_likelihood(kinematic, recording)
    assert found.markers[25] < found.markers[24] - 5.0
    assert found.markers[2] == 0.0


def test_trials_of_the_dynamic_filter(kinematic, recording):
    done = []
    tracking = TrackingFilter(DynamicReport(dynamic_filter(MODEL)), WarmStart(kinematic.kalman))
    found = trial_likelihood(tracking, recording, lambda at, total: done.append((at, total)))
    assert done[-1] == (40, 40)
    assert np.isfinite(found.markers).all()
    assert (found.load_readings[3:] == 6).all()
    assert (found.loads[3:] != 0.0).all()
