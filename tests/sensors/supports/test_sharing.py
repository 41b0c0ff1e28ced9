"""How parts share a load: sums and derivatives that hold exactly, and what is left to doubt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.sensors.supports.sharing import LEAST_FORCE_N, SPREAD_SHARE, about, shares
from tests.derivatives import slope

SIZE = np.array([100.0, 100.0, 400.0, 80.0, 80.0, 20.0])
"""Size of a wrench, N and N m."""

scenes = st.tuples(st.integers(1, 4), st.integers(0, 10_000))


def parts(count, rng):
    """Middles of some parts of a body, and their levers."""
    return rng.uniform(-0.6, 0.6, (count, 3)), rng.uniform(0.05, 0.15, count)


def lifted(points, force, rng):
    """A wrench that pushes up through somewhere between points."""
    between = rng.dirichlet(np.ones(len(points))) @ points
    return np.concatenate([force, np.cross(between, force) + rng.normal(size=3)])


def made(scene, pulls=True):
    """Parts, a wrench on all of them, and who may pull."""
    count, seed = scene
    rng = np.random.default_rng(seed)
    points, levers = parts(count, rng)
    return rng.normal(size=6) * SIZE, points, levers, [pulls] * count


def summed(covariance):
    """(6, 6) covariance of the sum of the parts' wrenches."""
    n = len(covariance) // 6
    return covariance.reshape(n, 6, n, 6).sum(axis=(0, 2))


@given(scenes, st.booleans())
def test_shares_sum_to_the_whole(scene, pulls):
    scene = made(scene, pulls)
    found = shares(*scene)
    np.testing.assert_allclose(found.wrench.sum(axis=0), scene[0], atol=1e-9 * np.abs(scene[0]).max())
    np.testing.assert_allclose(found.by_whole.sum(axis=0), np.eye(6), atol=1e-9)


@given(scenes, st.floats(-3.0, 3.0), st.integers(0, 10_000))
def test_who_may_pull_shares_linearly(scene, factor, seed):
    whole, *rest = made(scene)
    other = np.random.default_rng(seed).normal(size=6) * SIZE
    both = shares(whole + factor * other, *rest).wrench
    apart = shares(whole, *rest).wrench + factor * shares(other, *rest).wrench
    np.testing.assert_allclose(both, apart, atol=1e-8 * max(np.abs(apart).max(), 1.0))


@given(scenes, st.booleans())
def test_the_spread_is_a_covariance_of_what_cancels(scene, pulls):
    scene = made(scene, pulls)
    found = shares(*scene)
    largest = max(np.diag(found.covariance).max(), np.linalg.norm(scene[0]) ** 2)
    np.testing.assert_allclose(found.covariance, found.covariance.T, atol=1e-9 * largest)
    assert np.linalg.eigvalsh(found.covariance).min() > -1e-9 * largest
    np.testing.assert_allclose(summed(found.covariance), 0.0, atol=1e-9 * largest)


@given(scenes)
def test_nobody_pulls_at_the_floor_unless_alone(scene):
    scene = made(scene, pulls=False)
    found = shares(*scene).wrench
    bears = found.any(axis=1)
    assert bears.sum() == 1 or (found[:, 2] > -1e-9 * np.abs(scene[0]).max()).all()


@given(scenes)
def test_a_hand_that_holds_may_pull_and_stays(scene):
    """Every part that may not is pushed, and every one that may has its share."""
    whole, points, levers, _ = made(scene)
    points, levers = np.vstack([points, [0.0, 0.0, 0.5]]), np.append(levers, 0.06)
    found = shares(whole, points, levers, [*[False] * (len(points) - 1), True]).wrench
    assert found[-1].any()
    assert (found[:-1, 2] > -1e-9 * np.abs(whole).max()).all()


def test_a_part_that_would_be_pulled_leaves_the_load_to_the_others():
    """A line of action far outside a seat, on the other side of a knee."""
    points, levers = np.array([[0.0, 0.0, 0.5], [0.5, 0.0, 0.0]]), np.array([0.12, 0.08])
    force = np.array([0.0, 0.0, 300.0])
    whole = np.concatenate([force, np.cross([1.2, 0.0, 0.0], force)])
    assert shares(whole, points, levers, [True, True]).wrench[0, 2] < 0.0
    found = shares(whole, points, levers, [False, False])
    np.testing.assert_array_equal(found.wrench[0], 0.0)
    np.testing.assert_allclose(found.wrench[1], whole, atol=1e-9)
    np.testing.assert_array_equal(found.covariance[:6], 0.0)


def test_one_part_bears_all_without_a_doubt():
    whole, points, levers, pulls = made((1, 3))
    found = shares(whole, points, levers, pulls)
    np.testing.assert_allclose(found.wrench[0], whole, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found.by_whole[0], np.eye(6), atol=1e-9)
    np.testing.assert_allclose(found.covariance, 0.0, atol=1e-9 * (whole @ whole))


@given(st.integers(2, 4), st.integers(0, 10_000))
def test_a_load_in_their_middle_is_shared_by_areas(count, seed):
    """A force through the middle weighed by areas asks for no moment of any part."""
    rng = np.random.default_rng(seed)
    points, levers = parts(count, rng)
    share, force = levers**2 / (levers**2).sum(), np.array([20.0, -30.0, 400.0])
    whole = np.concatenate([force, np.cross(share @ points, force)])
    found = shares(whole, points, levers, [False] * count).wrench
    np.testing.assert_allclose(found[:, :3], share[:, None] * force, atol=1e-8)
    np.testing.assert_allclose(found[:, 3:], np.cross(points, found[:, :3]), atol=1e-8)


@given(st.integers(0, 10_000))
def test_the_line_of_action_decides_how_two_parts_share(seed):
    """The nearer part bears more, the more the nearer the line passes to it."""
    rng = np.random.default_rng(seed)
    points, levers = np.array([[0.0, 0.2, 0.0], [0.0, -0.2, 0.0]]), np.array([0.06, 0.06])
    force = np.array([0.0, 0.0, rng.uniform(50.0, 800.0)])
    at = np.sort(rng.uniform(-0.2, 0.2, 2))
    first = [
        shares(np.concatenate([force, np.cross([0, y, 0], force)]), points, levers, [False] * 2).wrench[0, 2]
        for y in at
    ]
    assert first[0] < first[1] + 1e-9
    assert first[0] >= 0.0 and first[1] <= force[2] + 1e-9


def test_the_derivative_is_that_by_the_whole():
    """Where the same parts bear."""
    rng = np.random.default_rng(2)
    points, levers = parts(3, rng)
    whole = lifted(points, np.array([5.0, 10.0, 500.0]), rng)
    found = shares(whole, points, levers, [True] * 3)
    numeric = slope(lambda w: shares(w, points, levers, [True] * 3).wrench, whole, 1e-2)
    np.testing.assert_allclose(found.by_whole, numeric, atol=1e-8)
    np.testing.assert_allclose(found.by_whole @ whole, found.wrench, atol=1e-9)


def test_the_spread_is_that_of_conditioning_a_gaussian():
    """Against the textbook form: what is known of the parts, less what their sum tells."""
    rng = np.random.default_rng(4)
    points, levers = parts(2, rng)
    whole = lifted(points, np.array([0.0, 30.0, 300.0]), rng)
    found = shares(whole, points, levers, [True] * 2)
    share, force = levers**2 / (levers**2).sum(), np.linalg.norm(whole[:3])
    sd = [
        np.repeat([SPREAD_SHARE * force, lever * force * part], 3)
        for lever, part in zip(levers, share, strict=True)
    ]
    X = [about(-point) for point in points]
    each = [x @ np.diag(one**2) @ x.T for x, one in zip(X, sd, strict=True)]
    gain = each[0] @ np.linalg.inv(each[0] + each[1])
    np.testing.assert_allclose(found.covariance[:6, :6], each[0] - gain @ each[0], atol=1e-8 * force**2)
    mean = [x @ np.concatenate([part * whole[:3], np.zeros(3)]) for x, part in zip(X, share, strict=True)]
    expected = mean[0] + gain @ (whole - mean[0] - mean[1])
    np.testing.assert_allclose(found.wrench[0], expected, atol=1e-8 * force)


@pytest.mark.parametrize("factor", [2.0, 10.0])
def test_the_spread_grows_with_the_load_but_not_below_a_little_one(factor):
    rng = np.random.default_rng(5)
    points, levers = parts(2, rng)
    whole = lifted(points, np.array([0.0, 0.0, 100.0]), rng)
    one, more = (shares(k * whole, points, levers, [True] * 2).covariance for k in (1.0, factor))
    np.testing.assert_allclose(more, factor**2 * one, atol=1e-9 * np.abs(more).max())
    little = whole * 0.1 * LEAST_FORCE_N / np.linalg.norm(whole[:3])
    none, less = (shares(k * little, points, levers, [True] * 2).covariance for k in (0.0, 1.0))
    np.testing.assert_allclose(less, none, atol=1e-12)
    assert np.diag(none).max() > 0.0


def test_a_wrench_is_moved_to_a_point():
    rng = np.random.default_rng(6)
    point, wrench = rng.normal(size=3), rng.normal(size=6)
    moved = about(point) @ wrench
    np.testing.assert_array_equal(moved[:3], wrench[:3])
    np.testing.assert_allclose(moved[3:], wrench[3:] - np.cross(point, wrench[:3]), atol=1e-12)
    np.testing.assert_allclose(about(-point) @ moved, wrench, atol=1e-12)
