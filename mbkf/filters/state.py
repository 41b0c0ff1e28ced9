"""The state of a filter on the body: mean on the manifold, covariance in its tangent space."""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.conventions import Array


@dataclass(frozen=True)
class FilterState:
    """Positions and velocities.

    Attributes:
        q: (nq,) configuration.
        v: (nv,) velocity, rad/s and m/s in the joints' own axes.
        P: (2 nv, 2 nv) covariance of (q, v) in the tangent space.
    """

    q: Array
    v: Array
    P: Array
