"""Offline orientation: later samples correct earlier ones (Rauch, Tung and Striebel 1965, on the error state)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import exponential, multiply
from mbkf.imu.orientation_ekf import ERRORS, OrientationState, Passage


class SmoothedOrientation(NamedTuple):
    """N sensors over T samples.

    Attributes:
        quaternion: (T, N, 4) sensor → NWU.
        gyro_bias: (T, N, 3) rad/s.
        variance: (T, N, 9) diagonal of the error's covariance.
    """

    quaternion: Array
    gyro_bias: Array
    variance: Array


def smoothed(start: OrientationState, passages: Iterable[Passage]) -> SmoothedOrientation:
    """Orientations of sensors, corrected by all their samples.

    With C = P Φᵀ P⁻₊₁⁻¹: the correction of a sample is δ = C (d₊₁ + δ₊₁), with the filter's own correction d₊₁ of the
    next one, and its covariance P + C (Pˢ₊₁ − P⁻₊₁) Cᵀ.

    Args:
        start: State at the first sample.
        passages: The filter's steps from each sample to the next.
    """
    states, gains, corrections, priors = [start], [], [], []
    for passage in passages:
        before = states[-1]
        ahead = passage.transition @ before.P
        gains.append(np.linalg.solve(passage.prior, ahead).transpose(0, 2, 1))
        corrections.append(passage.correction)
        priors.append(passage.prior)
        states.append(passage.state)
    count, n = len(states), len(start.quaternion)
    quaternion = np.array([state.quaternion for state in states])
    bias = np.array([state.gyro_bias for state in states])
    variance = np.empty((count, n, ERRORS))
    P, delta = states[-1].P, np.zeros((n, ERRORS))
    deltas = np.zeros((count, n, ERRORS))
    variance[-1] = np.diagonal(P, axis1=1, axis2=2)
    for k in range(count - 2, -1, -1):
        C = gains[k]
        delta = (C @ (corrections[k] + delta)[:, :, None])[:, :, 0]
        P = states[k].P + C @ (P - priors[k]) @ C.transpose(0, 2, 1)
        P = 0.5 * (P + P.transpose(0, 2, 1))
        deltas[k] = delta
        variance[k] = np.diagonal(P, axis1=1, axis2=2)
    turned = multiply(exponential(deltas[:, :, :3]), quaternion)
    turned /= np.sqrt((turned * turned).sum(axis=-1, keepdims=True))
    return SmoothedOrientation(turned, bias + deltas[:, :, 3:6], variance)
