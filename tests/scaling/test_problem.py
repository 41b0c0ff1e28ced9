"""The scaling problem: every derivative against finite differences of residuals written out here."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_names
from mbkf.model.protocol import load_protocol
from mbkf.scaling.problem import FACTOR_BOUNDS, ScalingProblem
from mbkf.scaling.records import FrameWeights, ScalingPrior, ScalingState
from mbkf.scaling.shoulders import without_shoulders
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.shoulder_girdle import shoulder_names
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_scale, reference_model

MODEL = reference_model()
BODY = MODEL.description
MARKERS = load_protocol("reference36").markers[:20]
FRAMES, FLEXIONS = 3, 2
SHOULDERS, TRIAL = 6, np.array([0, 0, 1])
ONE_FRAME = FrameWeights.moving(1, 1.0, 1.0)


def random_covariance(rng, size):
    A = rng.normal(size=(size, size))
    return 0.01 * (A @ A.T / size + 0.3 * np.eye(size))


@pytest.fixture(
    scope="module", params=[(0, 0), (FLEXIONS, 0), (FLEXIONS, 2)], ids=["rigid", "skin", "shoulders"]
)
def kinds(request):
    """Number of flexions that displace markers, and of trials in which shoulders are displaced."""
    return request.param


@pytest.fixture(scope="module")
def flexions(kinds):
    return kinds[0]


@pytest.fixture(scope="module")
def trials(kinds):
    return kinds[1]


@pytest.fixture(scope="module")
def problem(flexions, trials):
    """Some markers in some frames, one not at all, correlated prior, unequal weights of frames."""
    rng = np.random.default_rng(1)
    measured = rng.uniform(-1, 1, (FRAMES, len(MARKERS), 3))
    measured[rng.random((FRAMES, len(MARKERS))) < 0.3] = np.nan
    measured[:, 4] = np.nan
    prior = ScalingPrior(
        factors=random_scale(rng),
        factor_covariance=random_covariance(rng, 18),
        offsets_m=rng.uniform(-0.02, 0.02, (len(MARKERS), 3)),
        offset_precision=np.linalg.inv(0.01 * random_covariance(rng, 3 * len(MARKERS))),
    )
    if flexions:
        prior = replace(
            prior,
            slides_m=rng.uniform(-0.02, 0.02, (flexions, len(MARKERS), 3)),
            slide_precision=np.linalg.inv(0.01 * random_covariance(rng, 3 * len(MARKERS))),
        )
    if trials:
        size = trials * SHOULDERS
        prior = replace(
            prior,
            girdle_m=rng.uniform(-0.03, 0.03, size),
            girdle_covariance=0.01 * random_covariance(rng, size),
        )
    weights = FrameWeights(
        np.array([1.0, 0.5, 0.2]), np.array([0.0, 0.3, 1.0]), np.zeros(FRAMES, dtype=bool), np.zeros(FRAMES)
    )
    return ScalingProblem(BODY, MARKERS, measured, weights, prior, trial=TRIAL if trials else None)


@pytest.fixture(scope="module")
def state(flexions, trials):
    rng = np.random.default_rng(2)
    poses = np.array([moderate_pose(MODEL, rng) for _ in range(FRAMES)])
    displacements = rng.uniform(-0.03, 0.03, (1 + flexions, len(MARKERS), 3))
    raised = rng.uniform(-0.04, 0.04, trials * SHOULDERS)
    return ScalingState(poses, random_scale(rng), displacements[0], displacements[1:], raised)


def flexing(segment):
    """Joints of each flexion that moves the skin of a segment."""
    return BODY.skin[segment].flexions if segment in BODY.skin else ()


def bend(model, q, segment):
    """Rotation of a joint about y from neutral, of its rotation vector."""
    dofs = model.joint(segment).v
    return model.difference(model.neutral(), q)[dofs][0 if dofs.stop - dofs.start == 1 else 1]


def body_of_frame(problem, state, t):
    """The body whose shoulders are where they are in the trial of frame t, and (M, 3) displacements on the trunk."""
    if not state.girdle_m.size:
        return body_of(tuple(state.factors), ()), np.zeros((len(MARKERS), 3))
    raised = state.girdle_m.reshape(-1, 2, 3)[TRIAL[t]]
    body = body_of(tuple(state.factors), tuple(raised.ravel()))
    return body, problem.shoulders.girdle.on_trunk @ raised


@cache
def body_of(factors, raised_m):
    """The body of these factors; most differences vary poses and places alone."""
    moved = dict(zip(shoulder_names(BODY), raised_m, strict=True)) if raised_m else {}
    centres = np.array([moved.get(name, 0.0) for name in centre_names(BODY)])
    return HumanModel(BODY, np.array(factors), 80.0, centres_m=centres)


def residuals(problem, state):
    """All whitened residuals in one vector, from the module's description and not its code."""
    rows = []
    for t, q in enumerate(state.poses):
        model, beside = body_of_frame(problem, state, t)
        rotations, origins = model.placements(q)
        for i, marker in enumerate(MARKERS):
            if not np.isnan(problem.measured_m[t, i]).any():
                joint = model.joint(marker.segment).joint_id
                local = (
                    model.axis_scale(BODY.segment(marker.segment)) * marker.position_m
                    + state.offsets_m[i]
                    + beside[i]
                )
                for d, joints in enumerate(flexing(marker.segment)[: len(state.slides_m)]):
                    theta = np.mean([bend(model, q, joint) for joint in joints])
                    local = local + np.sin(theta / 2) / np.sin(np.pi / 6) * state.slides_m[d, i]
                at = origins[joint] + rotations[joint] @ local
                noise_m = marker.noise_m / np.sqrt(problem.weights.markers[t])
                rows.append((at - problem.measured_m[t, i]) / noise_m)
        deviation = problem.posture.reading(q).deviation / problem.posture.sd
        rows.append(np.sqrt(problem.weights.posture[t]) * deviation)
    if state.girdle_m.size:
        away = state.girdle_m - problem.prior.girdle_m
        rows.append(np.linalg.solve(np.linalg.cholesky(problem.prior.girdle_covariance), away))
    whiten = np.linalg.inv(np.linalg.cholesky(problem.prior.factor_covariance))
    rows.append(whiten @ (state.factors - problem.prior.factors))
    offsets = (state.offsets_m - problem.prior.offsets_m).ravel()
    rows.append(np.linalg.cholesky(problem.prior.offset_precision).T @ offsets)
    for slide, expected in zip(state.slides_m, problem.prior.slides_m, strict=True):
        rows.append(np.linalg.cholesky(problem.prior.slide_precision).T @ (slide - expected).ravel())
    return np.concatenate(rows)


def shared_size(state):
    return 18 + state.girdle_m.size + 3 * len(MARKERS) * (1 + len(state.slides_m))


def numeric_jacobian(problem, state, h=1e-6):
    """Of :func:`residuals` by (poses, factors, offsets)."""
    own, shared = FRAMES * MODEL.nv, shared_size(state)
    columns = []
    for i in range(own + shared):
        step = np.zeros(own + shared)
        step[i] = h
        ends = [problem.move(state, s * step[:own].reshape(FRAMES, -1), s * step[own:]) for s in (1, -1)]
        columns.append((residuals(problem, ends[0]) - residuals(problem, ends[1])) / (2 * h))
    return np.stack(columns, axis=1)


@pytest.fixture(scope="module")
def jacobian(problem, state):
    return numeric_jacobian(problem, state)


def test_cost_is_the_sum_of_squared_residuals(problem, state):
    total = (residuals(problem, state) ** 2).sum()
    assert problem.cost(state) == pytest.approx(total, rel=1e-12)
    assert problem.linearise(state).cost == pytest.approx(total, rel=1e-12)


def test_gradient_by_poses_factors_and_offsets(problem, state, jacobian):
    equations = problem.linearise(state)
    found = np.concatenate([equations.frame_gradient.ravel(), equations.corner_gradient])
    expected = jacobian.T @ residuals(problem, state)
    assert_near(found / np.abs(expected).max(), expected / np.abs(expected).max(), 1e-9)


@pytest.mark.parametrize("stands", [False, True])
def test_gradient_is_half_the_slope_of_the_cost(problem, state, stands):
    rng, h = np.random.default_rng(3), 1e-6
    weights = replace(
        problem.weights, standing=np.full(FRAMES, stands), upright=np.full(FRAMES, 0.7 * stands)
    )
    trial = TRIAL if state.girdle_m.size else None
    problem = ScalingProblem(BODY, MARKERS, problem.measured_m, weights, problem.prior, trial=trial)
    equations = problem.linearise(state)
    for _ in range(5):
        own, shared = rng.normal(size=(FRAMES, MODEL.nv)), rng.normal(size=shared_size(state))
        ahead, behind = (problem.cost(problem.move(state, s * h * own, s * h * shared)) for s in (1, -1))
        slope = 2 * ((equations.frame_gradient * own).sum() + equations.corner_gradient @ shared)
        assert slope == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


def test_the_arrow_is_the_gauss_newton_matrix(problem, state, jacobian):
    equations, nv = problem.linearise(state), MODEL.nv
    dense = jacobian.T @ jacobian
    size = np.abs(dense).max()
    for t in range(FRAMES):
        own = slice(t * nv, (t + 1) * nv)
        assert_near(equations.frames[t] / size, dense[own, own] / size, 1e-9)
        assert_near(equations.border.terms[t] / size, dense[own, FRAMES * nv :] / size, 1e-9)
    assert_near(equations.corner / size, dense[FRAMES * nv :, FRAMES * nv :] / size, 1e-9)


def test_the_information_is_that_of_the_equations_with_joint_centres(problem, state):
    """Without their rows that of the fit; the whole by differences of markers on bodies whose centres are displaced."""
    names, count, h = centre_names(BODY), 18, 1e-6
    found = problem.information(state)
    e = np.arange(count, count + len(names))
    kept = np.delete(np.arange(len(found)), e)
    fitted = problem.linearise(state).schur_complement()
    fitted = without_shoulders(fitted, problem.prior, count)
    assert_near(found[np.ix_(kept, kept)] / np.abs(fitted).max(), fitted / np.abs(fitted).max(), 1e-9)
    if state.girdle_m.size:
        return  # the rows of the centres are compared without shoulders, which move the same joints
    shares = np.array([problem.skin.shares(q) for q in state.poses])[:, :, : len(state.slides_m)]
    local = problem.local_m(state.factors, state.offsets_m)
    whiten = np.sqrt(problem.weights.markers)[:, None] / problem.noise_m
    columns = []
    for one in np.eye(len(names)):
        ends = []
        for sign in (1.0, -1.0):
            body = HumanModel(BODY, state.factors, 80.0, centres_m=sign * h * one)
            frames = []
            for t, q in enumerate(state.poses):
                places = (
                    local + np.einsum("md,dmi->mi", shares[t], state.slides_m)
                    if len(state.slides_m)
                    else local
                )
                frames.append(MarkerSensor(body, problem.segments, places).positions(q))
            ends.append(np.array(frames))
        slope = (ends[0] - ends[1]) / (2 * h) * np.where(problem.seen, whiten, 0.0)[..., None]
        columns.append(slope.ravel())
    by_centres = np.array(columns).T
    shown = problem.shown(state)
    by_pose = shown.by_pose.reshape(FRAMES, -1, MODEL.nv)
    frames = problem.linearise(state).frames
    expected = by_centres.T @ by_centres
    for t in range(FRAMES):
        across = by_pose[t].T @ by_centres.reshape(FRAMES, -1, len(names))[t]
        expected -= across.T @ np.linalg.solve(frames[t], across)
    assert_near(found[np.ix_(e, e)] / np.abs(expected).max(), expected / np.abs(expected).max(), 1e-7)


def test_missing_markers_say_nothing(problem, state):
    errors = problem.errors_m(state)
    np.testing.assert_array_equal(np.isnan(errors), np.isnan(problem.measured_m))
    columns = 18 + state.girdle_m.size + 3 * 4 + np.arange(3)  # the marker never seen
    assert (problem.linearise(state).border.terms[:, :, columns] == 0).all()


def test_other_samples_make_the_problem_that_they_alone_would(problem, state):
    other = np.where(np.isnan(problem.measured_m), 0.1, np.nan)
    trial = TRIAL if state.girdle_m.size else None
    alone = ScalingProblem(BODY, MARKERS, other, problem.weights, problem.prior, trial=trial)
    found = problem.with_measurements(other)
    assert (found.seen == alone.seen).all()
    assert (found.seen != problem.seen).all()
    assert found.cost(state) == pytest.approx(alone.cost(state))


def test_at_the_expected_state_only_the_markers_cost(problem, state):
    start = problem.start(np.repeat(MODEL.neutral()[None], FRAMES, axis=0))
    noise = np.array([m.noise_m for m in MARKERS])
    squares = np.nansum((problem.errors_m(start) / noise[:, None]) ** 2, axis=(1, 2))
    assert problem.cost(start) == pytest.approx(problem.weights.markers @ squares, rel=1e-12)


def test_with_unit_factors_and_no_offsets_markers_are_the_protocols():
    sensor, names = protocol_sensor(MODEL)
    prior = ScalingPrior(np.ones(18), np.eye(18), np.zeros((len(names), 3)), np.ones(len(names)))
    markers = load_protocol("reference36").markers
    problem = ScalingProblem(BODY, markers, np.full((1, len(names), 3), np.nan), ONE_FRAME, prior)
    own = problem.sensor(problem.start(np.zeros((0, 67))))
    q = moderate_pose(MODEL, np.random.default_rng(4))
    assert_near(own.positions(q), sensor.positions(q), 1e-15)


def test_factors_stay_inside_their_bounds(problem, state):
    far = np.concatenate([np.where(np.arange(18) % 2, 5.0, -5.0), np.zeros(shared_size(state) - 18)])
    factors = problem.move(state, np.zeros((FRAMES, MODEL.nv)), far).factors
    assert set(factors) == set(FACTOR_BOUNDS)
