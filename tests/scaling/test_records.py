"""Prior and state of scaling: one vector of unknowns, one precision."""

import numpy as np
import pytest

from mbkf.scaling.records import FrameWeights, ScalingPrior, ScalingState


@pytest.mark.parametrize("flexions", [0, 2])
def test_the_precision_goes_with_the_unknowns(flexions):
    rng, markers = np.random.default_rng(0), 2
    blocks = [np.diag(rng.uniform(1.0, 2.0, size)) for size in (3, 3 * markers, 3 * markers)]
    expected = rng.normal(size=(1 + flexions, markers, 3))
    prior = ScalingPrior(
        np.ones(3), np.linalg.inv(blocks[0]), expected[0], blocks[1], expected[1:], blocks[2]
    )
    step = rng.normal(size=3 + 3 * markers * (1 + flexions))
    places = expected + step[3:].reshape(expected.shape)
    state = ScalingState(np.zeros((0, 7)), 1.0 + step[:3], places[0], places[1:])
    np.testing.assert_allclose(prior.away(state), step, atol=1e-12)
    diagonal = np.concatenate([np.diag(b) for b in (blocks[0], blocks[1], *[blocks[2]] * flexions)])
    np.testing.assert_allclose(prior.precision, np.diag(diagonal), atol=1e-12)


def test_frames_of_a_movement_share_their_observations():
    weights = FrameWeights.moving(40, 10.0, 100.0)
    assert weights.markers.sum() == pytest.approx(10.0)
    assert weights.posture.tolist() == [1.0] * 40
    assert not weights.standing.any() and not weights.upright.any()
