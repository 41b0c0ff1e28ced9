"""States that push nothing leave a body's acceleration as it is."""

import numpy as np

from benchmarks.double_pendulum.forced_bodies import WithIdleStates
from tests.forced_bodies import DampedPendulum


def test_idle_states_push_nothing():
    own = DampedPendulum()
    body = WithIdleStates(own, 2)
    q, v, u = np.array([0.3]), np.array([1.0]), np.array([2.0, 50.0, -7.0])
    assert body.nu == 3
    np.testing.assert_array_equal(body.acceleration(q, v, u), own.acceleration(q, v, u[:1]))
    np.testing.assert_array_equal(body.linearise(q, v, u).by_u, [[1.0, 0.0, 0.0]])
    np.testing.assert_array_equal(body.transport(v), own.transport(v))
