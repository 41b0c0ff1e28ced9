"""Small forced bodies with plain coordinates, for integrators and plants, and whole bodies near a motion."""

import numpy as np

from mbkf.filters.torque.plant import ForcedState, TorquePlant
from mbkf.filters.torque.settings import SCHEMES
from mbkf.model.forced_body import LinearAcceleration
from tests.dynamics import DT


class PlainBody:
    """Everything of a forced body that plain coordinates make trivial."""

    nv = 1
    nu = 1

    def integrate(self, q, dv):
        return q + dv

    def difference(self, q0, q1):
        return q1 - q0

    def retraction(self, q, dv):
        return np.eye(self.nv), np.eye(self.nv)

    def transport(self, v):
        return np.zeros((self.nv, self.nv))


class Cart(PlainBody):
    """Two carts pushed by one force each: a = u / m, exactly solvable."""

    nv = 2
    nu = 2
    mass = np.array([2.0, 0.5])

    def acceleration(self, q, v, u):
        return u / self.mass

    def linearise(self, q, v, u):
        none = np.zeros((2, 2))
        return LinearAcceleration(self.acceleration(q, v, u), none, none, np.diag(1 / self.mass))

    def force_response(self, q):
        return np.diag(1 / self.mass)


class DampedPendulum(PlainBody):
    """A = u − 9 sin q − 0.4 v³: nothing about it is linear."""

    def acceleration(self, q, v, u):
        return u - 9.0 * np.sin(q) - 0.4 * v**3

    def linearise(self, q, v, u):
        by_q, by_v = np.diag(-9.0 * np.cos(q)), np.diag(-1.2 * v**2)
        return LinearAcceleration(self.acceleration(q, v, u), by_q, by_v, np.eye(1))

    def force_response(self, q):
        return np.eye(1)


def torque_plant(body):
    """The torque filter's plant of a whole body, without noise."""
    return TorquePlant(body, DT, lambda x: np.zeros_like(x.P), SCHEMES["FDMC"], wrenches=not body.loads_given)


def forced_state(body, motion, P):
    """The state of a motion q, v, a under foot wrenches w (12,)."""
    u = body.forces(motion.q, motion.v, motion.a, motion.w.reshape(2, 6))
    return ForcedState(motion.q, motion.v, u, P)
