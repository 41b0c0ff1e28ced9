"""Everything that calls itself a forced body speaks the whole protocol, with consistent shapes."""

import inspect

import numpy as np
import pytest

from benchmarks.double_pendulum.forced_bodies import WithIdleStates
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.pinocchio_pendulum import PinocchioPendulum
from mbkf.model.forced_body import ForcedBody, LinearAcceleration
from mbkf.model.human_dynamics import HumanDynamics
from tests.forced_bodies import Cart, DampedPendulum
from tests.motions import reference_model

MAKERS = {
    "HumanDynamics": lambda: (HumanDynamics(reference_model()), reference_model().neutral()),
    "Cart": lambda: (Cart(), np.zeros(2)),
    "DampedPendulum": lambda: (DampedPendulum(), np.zeros(1)),
    "DoublePendulum": lambda: (DoublePendulum(PendulumShape()), np.zeros(4)),
    "PinocchioPendulum": lambda: (PinocchioPendulum(PendulumShape()), np.zeros(4)),
    "WithIdleStates": lambda: (WithIdleStates(DampedPendulum(), 2), np.zeros(1)),
}


@pytest.mark.parametrize("name", MAKERS)
def test_speaks_the_protocol(name):
    body, q = MAKERS[name]()
    for member in [key for key in vars(ForcedBody) if not key.startswith("_")]:
        assert hasattr(body, member), member
        stated = inspect.getattr_static(ForcedBody, member)
        if inspect.isfunction(stated):
            expected = list(inspect.signature(stated).parameters)[1:]
            assert list(inspect.signature(getattr(body, member)).parameters) == expected
    v, u = np.full(body.nv, 0.1), np.ones(body.nu)
    found = body.linearise(q, v, u)
    assert isinstance(found, LinearAcceleration)
    np.testing.assert_allclose(found.a, body.acceleration(q, v, u), atol=1e-12)
    shapes = [part.shape for part in (found.a, found.by_q, found.by_v, found.by_u, body.transport(v))]
    square = (body.nv, body.nv)
    assert shapes == [(body.nv,), square, square, (body.nv, body.nu), square]
    np.testing.assert_allclose(body.force_response(q), found.by_u, atol=1e-12)
    assert [part.shape for part in body.retraction(q, v)] == [square, square]
    np.testing.assert_allclose(body.difference(q, body.integrate(q, v)), v, atol=1e-12)
