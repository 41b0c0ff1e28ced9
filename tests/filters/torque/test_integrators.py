"""Integrators: the order they have on plain coordinates and on the body's manifold, and what they solve."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.filters.torque.integrators import INTEGRATORS, Motion, integrator
from mbkf.model.human_dynamics import HumanDynamics
from tests.forced_bodies import Cart, DampedPendulum
from tests.motions import moderate_pose, random_model, worst

ORDERS = {"FE": 1, "HE": 2, "TF": 2, "TN": 2, "RK4": 4}
PUSH = np.array([1.5])


def run(name, body, start, u, seconds, steps):
    now = start
    for _ in range(steps):
        now = integrator(name)(body, now, u, seconds / steps)
    return now


def measured_order(name, body, start, u, seconds, steps, truth):
    errors = []
    for count in steps:
        end = run(name, body, start, u, seconds, count)
        errors.append(worst(np.concatenate([body.difference(truth.q, end.q), end.v - truth.v])))
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


def falling_body(seed=2):
    """The whole body, kicked, under constant torques."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    body = HumanDynamics(model, force_state="torque")
    q, v = moderate_pose(model, rng), rng.normal(size=model.nv)
    u = body.forces(q, v, np.where(body.kinematic, 0.0, rng.normal(size=model.nv)), np.zeros((2, 6)))
    return body, Motion(q, v), u


@pytest.mark.parametrize("name", INTEGRATORS)
def test_order_on_plain_coordinates(name):
    body, start = DampedPendulum(), Motion(np.array([0.3]), np.array([0.8]))
    truth = run("RK4", body, start, PUSH, 0.5, 1000)
    found = measured_order(name, body, start, PUSH, 0.5, (20, 40, 80), truth)
    assert found == pytest.approx(ORDERS[name], abs=0.15)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_order_on_the_manifold(name):
    """Along quaternions and a turning pelvis no order is lost."""
    body, start, u = falling_body()
    truth = run("RK4", body, start, u, 0.04, 32)
    steps = (2, 4, 8) if name == "RK4" else (8, 16, 32)
    found = measured_order(name, body, start, u, 0.04, steps, truth)
    assert found == pytest.approx(ORDERS[name], abs=0.35)


def test_both_trapezoidal_rules_solve_the_same_equation():
    body, start, u = falling_body()
    fixed, newton = (integrator(name)(body, start, u, 0.01) for name in ("TF", "TN"))
    assert worst(fixed.v - newton.v) < 1e-9
    assert worst(body.difference(fixed.q, newton.q)) < 1e-11
    rates = [body.acceleration(m.q, m.v, u) for m in (start, newton)]
    assert worst(newton.v - start.v - 0.005 * (rates[0] + rates[1])) < 1e-9


@pytest.mark.parametrize("name", [name for name in INTEGRATORS if name != "FE"])
def test_constant_acceleration_is_exact(name):
    now, u = Motion(np.array([1.0, -2.0]), np.array([0.5, 3.0])), np.array([4.0, -1.0])
    end, a = integrator(name)(Cart(), now, u, 0.2), u / Cart.mass
    np.testing.assert_allclose(end.v, now.v + 0.2 * a, rtol=1e-14)
    np.testing.assert_allclose(end.q, now.q + 0.2 * now.v + 0.02 * a, rtol=1e-14)


def test_euler_is_the_printed_one():
    """Thesis eq. 3.32: positions move with the old velocity."""
    now, u = Motion(np.array([1.0, -2.0]), np.array([0.5, 3.0])), np.array([4.0, -1.0])
    end = integrator("FE")(Cart(), now, u, 0.2)
    np.testing.assert_allclose(end.q, now.q + 0.2 * now.v, rtol=1e-15)
    np.testing.assert_allclose(end.v, now.v + 0.2 * u / Cart.mass, rtol=1e-15)


def test_unknown_integrator_is_refused():
    with pytest.raises(UnknownName, match="integrator"):
        integrator("RK5")
