"""Learned relations: they recover what is linear, know their error on time not seen, and doubt what is new."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.sensors.coordination.regression import learn

RIDGE = 0.05


def shown(seed=0, n=90, p=7, k=3, blocks=6, noise=0.1):
    """Features (n, p), targets (n, k) that follow them but for noise, and blocks of equal length."""
    rng = np.random.default_rng(seed)
    features = 2.0 + rng.normal(size=(n, p))
    targets = 1.0 + features @ rng.normal(size=(p, k)) + noise * rng.normal(size=(n, k))
    return features, targets, np.repeat(np.arange(blocks), n // blocks)


def fitted(features, targets, n, ridge=RIDGE):
    """Ridge regression by stacked least squares with a free constant; ``n`` weighs the ridge."""
    p = features.shape[1]
    A = np.vstack([np.column_stack([np.ones(len(features)), features]), np.zeros((p, p + 1))])
    A[len(features) :, 1:] = np.sqrt(n) * ridge * np.eye(p)
    return np.linalg.lstsq(A, np.vstack([targets, np.zeros((p, targets.shape[1]))]), rcond=None)[0]


@given(st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_what_is_linear_is_foretold_exactly(seed):
    features, targets, blocks = shown(seed, noise=0.0)
    found = learn(features, targets, blocks, 1e-6)
    np.testing.assert_allclose(found.predicted(features[3])[0], targets[3], atol=1e-6)
    assert found.error_sd.max() < 1e-6


def test_the_mean_is_that_of_ridge_regression():
    features, targets, blocks = shown()
    new = np.random.default_rng(1).normal(size=features.shape[1])
    constant, *weights = fitted(features, targets, len(features))
    found, _ = learn(features, targets, blocks, RIDGE).predicted(new)
    np.testing.assert_allclose(found, constant + new @ np.array(weights), atol=1e-9)


def test_errors_are_those_on_blocks_left_out():
    """The closed form equals fitting anew without each block."""
    features, targets, blocks = shown()
    short = np.empty_like(targets)
    for block in range(6):
        out = blocks == block
        solution = fitted(features[~out], targets[~out], len(features))
        short[out] = targets[out] - np.column_stack([np.ones(out.sum()), features[out]]) @ solution
    found = learn(features, targets, blocks, RIDGE)
    np.testing.assert_allclose(found.error_sd, np.sqrt((short**2).mean(axis=0)), rtol=1e-9)


def test_what_does_not_follow_keeps_its_mean():
    """Targets of their own, the same within a block: frames in plenty, but few independent ones."""
    rng = np.random.default_rng(2)
    blocks = np.repeat(np.arange(8), 15)
    features = np.repeat(rng.normal(size=(8, 6)), 15, axis=0) + 0.01 * rng.normal(size=(120, 6))
    targets = np.repeat(rng.normal(size=(8, 1)), 15, axis=0)
    found = learn(features, targets, blocks, RIDGE)
    mean, sd = found.predicted(features[0] + 1.0)
    assert mean == pytest.approx(targets.mean(axis=0))
    left_out = targets[::15, 0] - (targets[::15, 0].sum() - targets[::15, 0]) / 7
    assert sd == pytest.approx(np.sqrt((left_out**2).mean() * (1 + 1 / 8) * 7 / 5))


@given(st.integers(0, 1000), st.floats(1.0, 10.0))
@settings(max_examples=25, deadline=None)
def test_the_further_from_what_was_shown_the_less_is_known(seed, further):
    features, targets, blocks = shown(seed % 10)
    way = np.random.default_rng(seed).normal(size=features.shape[1])
    found = learn(features, targets, blocks, RIDGE)
    near, far = (found.predicted(found.features + k * way)[1] for k in (1.0, 1.0 + further))
    assert (far > near).all()


@pytest.mark.parametrize("blocks", [2, 3])
def test_few_blocks_tell_no_more_than_a_vague_mean(blocks):
    features, targets, _ = shown()
    found = learn(features, targets, np.repeat(np.arange(blocks), 90 // blocks), RIDGE)
    for at in (features[0], features[0] + 10.0):
        mean, sd = found.predicted(at)
        np.testing.assert_array_equal(mean, targets.mean(axis=0))
        assert (sd > 3.0 * targets.std(axis=0)).all()


def test_one_block_tells_nothing():
    features, targets, _ = shown()
    assert learn(features, targets, np.zeros(90, dtype=int), RIDGE) is None
