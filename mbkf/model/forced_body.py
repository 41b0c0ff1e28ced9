"""Interface of a body moved by forces, as the torque filter needs it: manifold, acceleration and derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

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
    """A body with configuration q, velocity v in its tangent space (nv,), and external forces u = T_e (nu,).

    Attributes:
        nv: Degrees of freedom.
        nu: Number of forces: residual, joint torques, reactions.
    """

    nv: int
    nu: int

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

    def force_response(self, q: Array) -> Array:
        """(nv, nu) derivative of the acceleration by the forces alone, M⁻¹ Bᵀ at a configuration q (nq,)."""
