"""What a dynamic filter needs to know of a body moved by forces: its manifold, its acceleration, and derivatives.

The whole-body model and the double pendulum both speak this protocol, so one filter serves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mbkf.conventions import Array


@dataclass(frozen=True)
class LinearAcceleration:
    """An acceleration a (nv,) and its derivatives by q (nv, nv), v (nv, nv) and forces u (nv, nu).

    The derivative by q is along the tangent vector δ of q ⊕ δ.
    """

    a: Array
    by_q: Array
    by_v: Array
    by_u: Array


class ForcedBody(Protocol):
    """A body with configuration q, velocity v in its tangent space (nv,), and external forces u = T_e (nu,)."""

    @property
    def nv(self) -> int:
        """Degrees of freedom."""

    @property
    def nu(self) -> int:
        """Number of forces: residual, joint torques, reactions."""

    def integrate(self, q: Array, dv: Array) -> Array:
        """The configuration q ⊕ dv."""

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) the tangent vector that takes q0 to q1."""

    def retraction(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """Derivatives (nv, nv) of q ⊕ dv by q and by dv; I and I for plain coordinates."""

    def transport(self, v: Array) -> Array:
        """(nv, nv) rate at which an error in q turns as the body moves with v; 0 for plain coordinates."""

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(nv,) M⁻¹ (Q_g + Bᵀ T_e), with gravity and velocity terms Q_g and forces T_e = u.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its derivatives.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            u: (nu,) forces.
        """


class PlainCoordinates:
    """The part of :class:`ForcedBody` that is alike for all bodies whose configuration is a plain vector.

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
        """(nv, nv) zero: an error in q stays what it is as the body moves."""
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
