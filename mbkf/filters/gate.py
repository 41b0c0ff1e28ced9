"""Which markers of a frame to believe: an innovation gate per marker."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.settings import KinematicSettings


def believable(
    innovation_m: Array, jacobian: Array, covariance: Array, noise_m: Array, settings: KinematicSettings
) -> BoolArray:
    """(M,) whether each marker is seen and inside its gate: yᵀ S⁻¹ y ≤ gate, S = H P Hᵀ + R, or near enough.

    When more than half of the markers fall outside, the state is wrong and not the markers, and all are believed.

    Args:
        innovation_m: (M, 3) measured minus predicted, NaN where missing.
        jacobian: (M, 3, nv) marker Jacobian H.
        covariance: (nv, nv) predicted covariance P of the configuration.
        noise_m: (M,) marker noise.
        settings: Gate and radius.
    """
    S = (jacobian @ covariance) @ jacobian.transpose(0, 2, 1)
    S[:, np.arange(3), np.arange(3)] += noise_m[:, None] ** 2
    y = np.nan_to_num(innovation_m)
    distance = (y * np.linalg.solve(S, y[:, :, None])[:, :, 0]).sum(axis=1)
    inside = (distance <= settings.gate) | ((y**2).sum(axis=1) <= settings.gate_radius_m**2)
    seen = np.asarray(~np.isnan(innovation_m).any(axis=1))
    mostly_outside = inside[seen].sum() < 0.5 * seen.sum()
    return seen if mostly_outside else seen & inside
