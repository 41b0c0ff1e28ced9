"""Small forced bodies with plain coordinates, shared by the tests of integrators and plants."""

import numpy as np

from mbkf.model.forced_body import LinearAcceleration


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


class DampedPendulum(PlainBody):
    """A = u − 9 sin q − 0.4 v³: nothing about it is linear."""

    def acceleration(self, q, v, u):
        return u - 9.0 * np.sin(q) - 0.4 * v**3

    def linearise(self, q, v, u):
        by_q, by_v = np.diag(-9.0 * np.cos(q)), np.diag(-1.2 * v**2)
        return LinearAcceleration(self.acceleration(q, v, u), by_q, by_v, np.eye(1))
