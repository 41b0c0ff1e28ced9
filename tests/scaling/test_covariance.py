"""What scaling leaves unknown, by differences of places and by scaling again with other noise."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_covariance, centre_names
from mbkf.numerics.levenberg_marquardt import minimise
from mbkf.scaling.covariance import body_covariance, factor_errors
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingPrior, ScalingState
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import assert_near, moderate_pose, reference_model
from tests.scaling.test_problem import BODY, MARKERS, ONE_FRAME, random_covariance

COUNT, SIZE = len(BODY.scale_factors), len(BODY.scale_factors) + 3 * len(MARKERS)
CENTRES = centre_names(BODY)


@pytest.fixture(scope="module")
def problem():
    """A scaling problem of one frame, with a prior in which factors, and in which offsets, belong together."""
    rng = np.random.default_rng(4)
    prior = ScalingPrior(
        factors=np.ones(COUNT),
        factor_covariance=0.1 * random_covariance(rng, COUNT),
        offsets_m=np.zeros((len(MARKERS), 3)),
        offset_precision=np.linalg.inv(0.01 * random_covariance(rng, SIZE - COUNT)),
    )
    return ScalingProblem(BODY, MARKERS, np.zeros((1, len(MARKERS), 3)), ONE_FRAME, prior)


def _without_centres(covariance):
    kept = np.delete(np.arange(len(covariance)), np.arange(COUNT, COUNT + len(CENTRES)))
    return covariance[np.ix_(kept, kept)]


def test_places_follow_factors_and_offsets(problem):
    rng, h = np.random.default_rng(5), 1e-6
    factors, offsets = rng.uniform(0.9, 1.1, COUNT), 0.01 * rng.normal(size=(len(MARKERS), 3))

    def told(x):
        return np.r_[x[:COUNT], problem.local_m(x[:COUNT], x[COUNT:].reshape(-1, 3)).ravel()]

    at = np.r_[factors, offsets.ravel()]
    slopes = [(told(at + h * one) - told(at - h * one)) / (2 * h) for one in np.eye(SIZE)]
    assert_near(problem.places_by_unknowns(), np.array(slopes).T, 1e-9)


def test_the_covariance_is_that_of_the_places_of_drawn_errors(problem):
    """Σ = T J⁻¹ Tᵀ where joint centres act on nothing: the information about places is T⁻ᵀ J T⁻¹, in any units."""
    information = np.linalg.inv(random_covariance(np.random.default_rng(6), SIZE))
    of_centres = slice(COUNT, COUNT + len(CENTRES))
    whole = np.insert(np.insert(information, [COUNT] * len(CENTRES), 0.0, 0), [COUNT] * len(CENTRES), 0.0, 1)
    found = body_covariance(problem, whole)
    np.testing.assert_allclose(found.covariance[of_centres, of_centres], centre_covariance(BODY), atol=1e-12)
    assert found.factors == tuple(BODY.scale_factors)
    assert found.markers == tuple(marker.name for marker in MARKERS)
    T = problem.places_by_unknowns()
    np.testing.assert_allclose(
        T.T @ np.linalg.inv(_without_centres(found.covariance)) @ T, information, rtol=1e-6, atol=1e-6
    )


def test_errors_of_factors_are_those_of_the_inverse_with_known_centres(problem):
    whole = random_covariance(np.random.default_rng(9), SIZE + len(CENTRES))
    expected = np.linalg.inv(_without_centres(whole))
    np.testing.assert_allclose(factor_errors(problem, whole), np.sqrt(np.diag(expected)[:COUNT]), rtol=1e-8)


def test_scaling_errs_as_it_says(problem):
    """Bodies drawn from the prior, noise from the markers': squared errors are of the size of the covariance."""
    rng, errors, trials = np.random.default_rng(7), [], 4
    roots = [
        np.linalg.cholesky(problem.prior.factor_covariance),
        np.linalg.cholesky(np.linalg.inv(problem.prior.offset_precision)),
    ]
    noise_m = np.array([marker.noise_m for marker in MARKERS])[:, None]
    model = reference_model()
    for _ in range(trials):
        factors = problem.prior.factors + roots[0] @ rng.normal(size=COUNT)
        offsets = (roots[1] @ rng.normal(size=SIZE - COUNT)).reshape(-1, 3)
        q = moderate_pose(model, rng, 0.0)
        true = ScalingState(q[None], factors, offsets)
        centres = np.linalg.cholesky(centre_covariance(BODY)) @ rng.normal(size=len(CENTRES))
        body = HumanModel(BODY, factors, 80.0, centres_m=centres)
        sensor = MarkerSensor(body, problem.segments, problem.local_m(factors, offsets))
        seen = sensor.positions(q) + noise_m * rng.normal(size=(len(MARKERS), 3))
        one = problem.with_measurements(seen[None])
        solution = minimise(true, one.linearise, one.cost, one.move, tolerance=1e-4)
        found, known = solution.state, body_covariance(one, one.information(solution.state))
        away = np.r_[
            found.factors - factors,
            -centres,
            (one.local_m(found.factors, found.offsets_m) - one.local_m(factors, offsets)).ravel(),
        ]
        errors.append(away @ np.linalg.solve(known.covariance, away) / len(away))
    assert np.mean(errors) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / (SIZE * trials)))
