"""A body in a cloud of points: likelihood, gradient and growth of the mixture's expectation–maximisation."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mbkf.marker_sets.equipment import EQUIPMENTS, equipped_weight
from mbkf.marker_sets.places import worn_places
from mbkf.marker_sets.posed_cloud import OFF_BODY, ROOM_M3, SOLE_SD_RAD, CloudProblem
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.scaling.standing import UprightPosture
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.marker_sets.worn import standing

PLACES = worn_places(load_body())
WEIGHT = equipped_weight(PLACES, EQUIPMENTS[0])
WIDTH_M = 0.05


def upright(problem, rng, spread=0.3):
    q = problem.model.integrate(
        problem.model.neutral(), spread * problem.model.posture_sd * rng.uniform(-1, 1, problem.model.nv)
    )
    return problem.model.integrate(q, np.r_[0.1, -0.2, 0.9, 0.1, -0.05, 2.0, np.zeros(problem.model.nv - 6)])


def factors_of(rng):
    return 0.95 + rng.uniform(-0.05, 0.05, len(PLACES.body.scale_factors))


def sized(factors):
    """The components on a body of these scale factors."""
    body = PLACES.body
    scale = np.array([body.segment(name).scale_matrix for name in PLACES.segments])
    model = HumanModel(body, factors, body.reference_mass_kg)
    return MarkerSensor(model, PLACES.segments, (scale @ factors) * PLACES.position_m)


@pytest.fixture(scope="module")
def scene():
    """A problem with points around a body of known pose and factors."""
    rng = np.random.default_rng(4)
    blank = CloudProblem(PLACES, np.zeros((1, 3)), WEIGHT)
    q, factors = upright(blank, rng), factors_of(rng)
    chosen = rng.choice(len(WEIGHT), 40, replace=False, p=WEIGHT)
    points = sized(factors).positions(q)[chosen] + rng.normal(0.0, 0.01, (40, 3))
    return CloudProblem(PLACES, points, WEIGHT), q, factors


def objective(problem, q, factors, width_m=WIDTH_M):
    _, likelihood = problem.shares(sized(factors).positions(q), width_m)
    return likelihood + problem.priors(q, factors)


def test_a_problem_of_some_points_shares_them_as_the_whole_does(scene):
    problem, q, factors = scene
    positions, chosen = sized(factors).positions(q), np.array([3, 8, 30])
    named = np.random.default_rng(0).uniform(0.5, 2.0, (40, len(WEIGHT))) * WEIGHT
    for whole in (problem, CloudProblem(PLACES, problem.points_m, named)):
        shares, _ = whole.of_points(chosen).shares(positions, WIDTH_M)
        np.testing.assert_allclose(shares, whole.shares(positions, WIDTH_M)[0][chosen], rtol=1e-12)


def test_shares_are_probabilities(scene):
    problem, q, factors = scene
    positions = sized(factors).positions(q)
    for width in (0.2, 0.05, 0.01):
        shares, _ = problem.shares(positions, width)
        assert (shares >= 0.0).all()
        assert (shares.sum(axis=1) < 1.0).all(), "some is left for no body"
    far, _ = problem.shares(positions, 0.05, problem.points_m + 3.0)
    assert far.sum(axis=1).max() < 1e-6, "a point far away is of no body"


def test_the_likelihood_is_that_of_the_mixture(scene):
    problem, q, factors = scene
    positions = sized(factors).positions(q)
    shares, found = problem.shares(positions, WIDTH_M)
    sd = np.sqrt(WIDTH_M**2 + PLACES.sd_m**2)
    density = np.array(
        [
            w * multivariate_normal.pdf(problem.points_m, mean, s**2)
            for w, mean, s in zip(WEIGHT, positions, sd, strict=True)
        ]
    ).T
    total = (1.0 - OFF_BODY) * density.sum(axis=1) + OFF_BODY / ROOM_M3
    assert found == pytest.approx(np.log(total).sum(), rel=1e-9)
    np.testing.assert_allclose(shares, (1.0 - OFF_BODY) * density / total[:, None], atol=1e-9)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_gradient_is_that_of_the_objective_by_pose_and_factors(scene, seed):
    """By EM's theory that of the expected likelihood, with the shares held, is that of the likelihood itself."""
    problem, true, _ = scene
    rng = np.random.default_rng(seed)
    q = problem.model.integrate(true, rng.normal(0.0, 0.03, problem.model.nv))
    factors = factors_of(rng)
    reading, by_factors = problem.reading(q, factors)
    shares, _ = problem.shares(reading.positions_m, WIDTH_M)
    matrix, gradient = problem.equations(reading, shares, problem.points_m, WIDTH_M, q, (by_factors, factors))
    step, nv = 1e-5, problem.model.nv

    def at(d):
        return objective(problem, problem.model.integrate(q, d[:nv]), factors + d[nv:])

    numeric = np.array([(at(step * e) - at(-step * e)) / (2 * step) for e in np.eye(len(gradient))])
    # components with next to no share are left out, which tells in the third digit
    np.testing.assert_allclose(gradient, numeric, atol=0.01 * np.abs(numeric).max())
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
    assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.linalg.eigvalsh(matrix).max()


@pytest.mark.parametrize("width_m", [0.12, 0.05, 0.025])
def test_a_pass_does_not_lower_the_objective(scene, width_m):
    problem, true, _ = scene
    rng = np.random.default_rng(7)
    q = problem.model.integrate(true, rng.normal(0.0, 0.05, problem.model.nv))
    body = problem.posed(q, 0.95, (width_m,))
    for fit in (
        lambda one: problem.posed(one.q, 0.95, (width_m,)),
        lambda one: problem.fitted(one, (width_m,)),
    ):
        posteriors = [body.log_posterior]
        for _ in range(8):
            body = fit(body)
            posteriors.append(body.log_posterior)
        assert np.diff(posteriors).min() > -0.01
        assert posteriors[-1] > posteriors[0]


def test_worth_is_the_objective(scene):
    problem, q, _ = scene
    body = problem.fitted(problem.posed(q, 0.95, (0.05,)), (0.05, 0.03))
    assert body.log_posterior == pytest.approx(objective(problem, body.q, body.factors, 0.03))


def test_a_size_is_a_body_of_these_factors(scene):
    """Posing a small body in the cloud is posing the reference body in the enlarged cloud."""
    problem, q, _ = scene
    one = problem.posed(q, 0.8, (0.1, 0.08))
    np.testing.assert_array_equal(one.factors, 0.8)
    whole = np.full_like(one.factors, 0.8)
    assert one.log_posterior == pytest.approx(objective(problem, one.q, whole, 0.08))


def test_a_turned_cloud_has_the_same_objective_for_the_turned_body(scene):
    problem, q, factors = scene
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = CloudProblem(PLACES, problem.points_m @ turn.T + [1.0, 2.0, 0.0], WEIGHT)
    moved = q.copy()
    moved[:3] = turn @ q[:3] + [1.0, 2.0, 0.0]
    half = np.sqrt(0.5)
    x, y, z, w = q[3:7]
    moved[3:7] = [half * (x - y), half * (y + x), half * (z + w), half * (w - z)]
    assert objective(turned, moved, factors) == pytest.approx(objective(problem, q, factors), abs=1e-6)


def test_knees_bend_one_way(scene):
    problem, _, factors = scene
    joint = problem.model.joint("right_shank")
    worth = []
    for angle in (0.5, -0.5):
        step = np.zeros(problem.model.nv)
        step[np.arange(problem.model.nv)[joint.v][1]] = angle
        worth.append(problem.priors(problem.model.integrate(problem.model.neutral(), step), factors))
    assert abs(worth[0] - worth[1]) > 5.0


def test_standing_soles_are_level(scene):
    """The prior of a sole's pitch: its part of the objective, and the gradient of the whole."""
    problem, q, factors = scene
    level = CloudProblem(PLACES, problem.points_m, WEIGHT, problem.model, standing=True)
    step = np.zeros(problem.model.nv)
    step[problem.model.joint("right_foot").v][1] = 0.3
    soles = UprightPosture(problem.model, dict.fromkeys(problem.model.roles.feet, SOLE_SD_RAD))
    for pose in (q, problem.model.integrate(q, step)):
        tilt = soles.residuals(problem.model, pose)
        assert level.priors(pose, factors) == pytest.approx(problem.priors(pose, factors) - 0.5 * tilt @ tilt)
        reading, _ = level.reading(pose, factors)
        shares, _ = level.shares(reading.positions_m, WIDTH_M)
        _, gradient = level.equations(reading, shares, level.points_m, WIDTH_M, pose)
        _, other = problem.equations(reading, shares, level.points_m, WIDTH_M, pose)
        numeric = [
            -0.5
            * np.diff(
                [
                    soles.residuals(problem.model, problem.model.integrate(pose, d))
                    @ soles.residuals(problem.model, problem.model.integrate(pose, d))
                    for d in (-e, e)
                ]
            )[0]
            / 2e-6
            for e in 1e-6 * np.eye(problem.model.nv)
        ]
        np.testing.assert_allclose(gradient - other, numeric, atol=1e-4)


def test_a_body_is_found_where_its_own_markers_are():
    """Markers of a synthetic person, from a start 10 cm and 10° off: the pose comes back to their places."""
    worn = standing("plug_in_gait", 2)
    problem = CloudProblem(PLACES, worn.points_m, WEIGHT)
    start = problem.model.neutral()
    start[:2] = np.median(worn.points_m[:, :2], axis=0) + 0.07
    start[2] = np.median(worn.points_m[[s == "pelvis" for s in worn.segments.values()], 2])
    body = problem.fitted(
        problem.posed(start, 0.97, (0.12,) * 5), (0.08, 0.06, 0.05, 0.04, 0.03, 0.03, 0.025, 0.025)
    )
    index = PLACES.segment_index[body.shares.argmax(axis=1)]
    names = [segment.name for segment in PLACES.body.segments]
    right = [names[s] == worn.segments[n] for s, n in zip(index, worn.markers.names, strict=True)]
    assert np.mean(right) >= 0.9
    nearest = MarkerSensor(sized(body.factors).model, ["pelvis"], np.zeros((1, 3))).positions(body.q)
    assert np.linalg.norm(nearest[0, :2] - np.median(worn.points_m[:, :2], axis=0)) < 0.2
