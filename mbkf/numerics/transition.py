"""Transition Φ of an error from one frame to the next: dense, or by its parts where rates move positions on a manifold.

A state (q, v, a …, rest) with k orders of rates moves by q' = q ⊕ s, a step s that the rates add up to, while rates
carry one another dof by dof:

    Φ = [[A, B p₁, …, B pₖ, 0], [0, R ⊗ 1, 0], [0, 0, 1]]

with the derivatives A and B of the retraction by q and by s, which couple the dofs of one joint only.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from mbkf.conventions import Array, Int32Array


class Transition(Protocol):
    """Φ (N, N) of one step, in any form."""

    def matrix(self, size: int) -> Array:
        """(N, N) Φ of a state of ``size`` components."""

    def forward(self, vector: Array) -> Array:
        """(N,) Φ times a tangent vector (N,)."""


class DenseTransition(NamedTuple):
    """Φ (N, N) as a matrix."""

    phi: Array

    def matrix(self, size: int) -> Array:  # noqa: ARG002, the matrix knows its size
        """(N, N) Φ."""
        return self.phi

    def forward(self, vector: Array) -> Array:
        """(N,) Φ times a tangent vector (N,)."""
        return self.phi @ vector


class RateTransition(NamedTuple):
    """Φ of one step.

    Attributes:
        A: (nv, nv) derivative of the next configuration by this one.
        B: (nv, nv) by the step.
        joints: (J, 2) first dof and end of each joint; A and B are zero between joints.
        push: (k,) p, what each order of rates adds to the step.
        rates: (k, k) R, the next rates of a dof by its rates.
    """

    A: Array
    B: Array
    joints: Int32Array
    push: Array
    rates: Array

    def matrix(self, size: int) -> Array:
        """(N, N) Φ of a state of ``size`` components."""
        nv, phi = len(self.A), np.eye(size)
        phi[:nv, :nv] = self.A
        every = np.arange(nv)
        for j, push in enumerate(self.push, start=1):
            np.multiply(self.B, push, out=phi[:nv, j * nv : (j + 1) * nv])
            for i, factor in enumerate(self.rates[:, j - 1], start=1):
                phi[i * nv + every, j * nv + every] = factor
        return phi

    def forward(self, vector: Array) -> Array:
        """(N,) Φ times a tangent vector (N,)."""
        moved = vector.copy()
        position, rates = self._parts(vector)
        q, v = self._parts(moved)
        q[:] = self.A @ position + self.B @ (self.push @ rates)
        v[:] = self.rates @ rates
        return moved

    def _parts(self, vector: Array) -> tuple[Array, Array]:
        """Views: (nv,) positions and (k, nv) rates of a vector (N,)."""
        nv, k = len(self.A), len(self.push)
        return vector[:nv], vector[nv : (1 + k) * nv].reshape(k, nv)
