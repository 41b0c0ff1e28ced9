"""Forced bodies with plain coordinates, and bodies with further states that push nothing."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.forced_body import ForcedBody, LinearAcceleration


class PlainCoordinates:
    """The members of :class:`ForcedBody` that all bodies with a plain vector as configuration share.

    Attributes:
        nv: Number of coordinates.
    """

    nv: int

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nv,) q + dv."""
        return q + dv

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) from q_0 to q_1."""
        return q1 - q0

    def retraction(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """Derivatives (nv, nv) of q + dv by both: identities."""
        del q, dv
        return np.eye(self.nv), np.eye(self.nv)

    def transport(self, v: Array) -> Array:
        """(nv, nv) zero: an error in q keeps its components as the body moves."""
        del v
        return np.zeros((self.nv, self.nv))


class WithIdleStates:
    """A forced body whose u carries further states behind its forces that push nothing, such as marker artefacts.

    Attributes:
        body: The body.
        idle: How many such states there are.
        nv, nu: Degrees of freedom; forces and idle states.
    """

    def __init__(self, body: ForcedBody, idle: int) -> None:
        self.body, self.idle = body, idle
        self.nv, self.nu = body.nv, body.nu + idle

    def integrate(self, q: Array, dv: Array) -> Array:
        """The configuration q ⊕ dv."""
        return self.body.integrate(q, dv)

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) the tangent vector that takes q0 to q1."""
        return self.body.difference(q0, q1)

    def retraction(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """The body's own."""
        return self.body.retraction(q, dv)

    def transport(self, v: Array) -> Array:
        """The body's own."""
        return self.body.transport(v)

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(nv,) under the forces alone.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """
        return self.body.acceleration(q, v, u[: self.body.nu])

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its derivatives, which are 0 by idle states.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """
        own = self.body.linearise(q, v, u[: self.body.nu])
        by_u = np.hstack([own.by_u, np.zeros((self.nv, self.idle))])
        return LinearAcceleration(own.a, own.by_q, own.by_v, by_u)

    def force_response(self, q: Array) -> Array:
        """(nv, nu) M⁻¹ Bᵀ at a configuration q (nq,), 0 by idle states."""
        return np.hstack([self.body.force_response(q), np.zeros((self.nv, self.idle))])
