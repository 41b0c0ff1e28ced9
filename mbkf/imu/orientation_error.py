"""Error of an orientation against a reference: total, heading, inclination (BROAD's protocol, no alignment)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import ShapeError
from mbkf.imu.frames import conjugate, multiply


@dataclass(frozen=True)
class OrientationError:
    """Root-mean-square errors, rad.

    Attributes:
        total: Angle of the rotation between the two.
        heading: Angle of its part about the vertical.
        inclination: Angle of the rest.
        samples: Samples compared.
    """

    total: float
    heading: float
    inclination: float
    samples: int


def error_angles(estimate: Array, reference: Array) -> tuple[Array, Array, Array]:
    """Total, heading and inclination error (T,), rad, of quaternions (T, 4) in one world whose z is vertical.

    With e = q̂ ⊗ q*: 2 acos |w|, 2 atan(z/w), 2 acos √(w² + z²) (Laidig et al., Data 2021, 6(7):72, section 4).

    Raises:
        ShapeError: The two differ in length.
    """
    if estimate.shape != reference.shape:
        raise ShapeError("reference", str(estimate.shape), reference.shape)
    x, y, z, w = np.moveaxis(multiply(estimate, conjugate(reference)), -1, 0)
    tilt, turn = np.hypot(x, y), np.hypot(z, w)
    total = 2.0 * np.arctan2(np.hypot(tilt, z), np.abs(w))
    heading = 2.0 * np.arctan2(np.where(w < 0.0, -z, z), np.abs(w))
    return total, heading, 2.0 * np.arctan2(tilt, turn)


def orientation_error(
    estimate: Array, reference: Array, counted: BoolArray | None = None
) -> OrientationError:
    """RMS errors over the samples where both orientations are known.

    Args:
        estimate: (T, 4) orientations, NaN where unknown.
        reference: (T, 4) true ones, NaN where unknown.
        counted: (T,) samples that count; all where None.
    """
    there = np.isfinite(estimate).all(axis=1) & np.isfinite(reference).all(axis=1)
    if counted is not None:
        there &= counted
    angles = error_angles(estimate[there], reference[there])
    rms = [float(np.sqrt(np.mean(one**2))) if there.any() else float("nan") for one in angles]
    return OrientationError(rms[0], rms[1], rms[2], int(there.sum()))
