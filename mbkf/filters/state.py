"""The state of a filter on the body: mean on the manifold, covariance in its tangent space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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

    def reversed_in_time(self) -> FilterState:
        """The same instant of the motion played backwards: v changes sign, and its covariance with q."""
        nv = len(self.v)
        sign = np.concatenate([np.ones(nv), -np.ones(nv)])
        return FilterState(self.q, -self.v, sign[:, None] * self.P * sign)
