"""The pendulum with given reactions is the pendulum with the same efforts as states."""

import numpy as np

from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.settings.pendulum import REACTIONS, REST, GivenReactions


def test_given_reactions_push_as_states_do():
    rng = np.random.default_rng(0)
    whole = DoublePendulum(PendulumShape())
    q, v, efforts = rng.normal(size=4), rng.normal(size=4), 100.0 * rng.normal(size=7)
    body, u = GivenReactions(whole), np.concatenate([efforts[REST], efforts[REACTIONS]])
    np.testing.assert_array_equal(body.acceleration(q, v, u), whole.acceleration(q, v, efforts))
    found, wanted = body.linearise(q, v, u), whole.linearise(q, v, efforts)
    np.testing.assert_array_equal(found.by_u, wanted.by_u[:, REST])
    np.testing.assert_array_equal(found.by_q, wanted.by_q)
    np.testing.assert_allclose(body.force_response(q), found.by_u, rtol=1e-9)
