"""Steps of the covariance of a body moved by forces, (q, v, u), by the compiled kernel.

``covariance.c`` takes the light step, ``exact_forces.c`` the exact one.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from mbkf.conventions import Array, Int32Array
from mbkf.kernel.loading import Library, library
from mbkf.numerics.forced_error import ForceDensity, ForcedRates, LightStep, MotionStep, gauss_rules


def light_step(P: Array, step: LightStep, joints: Int32Array, density: ForceDensity) -> Array:
    """(n, n) Φ P Φᵀ + Q, Q by the series of thesis eq. 2.45.

    Args:
        P: (n, n) covariance, symmetric.
        step: Φ.
        joints: (J, 2) first dof and end of each joint.
        density: Plant noise.
    """
    A, B, by_u, dt, push = step
    U = np.asfortranarray(by_u)
    return _kernel().propagate_forces(P, A, B, U, joints, dt, push, density.velocities, density.forces)


def exact_step(
    P: Array, rates: ForcedRates, joints: Int32Array, density: ForceDensity, dt_s: float
) -> tuple[MotionStep, Array] | None:
    """Exact Φ, and (n, n) Φ P Φᵀ + Q (thesis eqs. 2.39, 2.43); None where F Δt is too large for one series.

    Args:
        P: (n, n) covariance, symmetric.
        rates: F.
        joints: (J, 2) first dof and end of each joint.
        density: Plant noise.
        dt_s: Time step Δt.
    """
    A, U = rates.motion(order="F"), np.asfortranarray(rates.by_u)
    terms, motion, push, after = _kernel().exact_forces(
        P, A, U, joints, dt_s, density.velocities, density.forces, gauss_rules()
    )
    return (MotionStep(motion, push), after) if terms else None


def _kernel() -> Library:
    """The kernel, which a body that calls these functions has."""
    return cast("Library", library())
