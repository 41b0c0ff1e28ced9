"""Rotation vectors of unit quaternions, for many rotations at once, and the derivative of a screw motion."""

from __future__ import annotations

import math

import numpy as np

from mbkf.conventions import Array

SMALL_TURN_RAD = 0.15
"""Below this a series is more exact than the closed form."""


_DIAGONAL = np.diag_indices(3)


def skew(vectors: Array) -> Array:
    """(…, 3, 3) matrices [v]× of vectors (…, 3)."""
    v = np.asarray(vectors)
    matrices = np.zeros((*v.shape, 3))
    matrices[..., 2, 1], matrices[..., 0, 2], matrices[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    matrices[..., 1, 2], matrices[..., 2, 0], matrices[..., 0, 1] = -v[..., 0], -v[..., 1], -v[..., 2]
    return matrices


def exponential_and_left_jacobian(vectors: Array) -> tuple[Array, Array]:
    """Exp(θ) (N, 3, 3) and its left Jacobian J(θ) (N, 3, 3), for many rotation vectors θ (N, 3), rad.

    Exp(θ) = I + [θ]ₓ J(θ), J(θ) = I + a [θ]ₓ + b [θ]ₓ², a = (1 − cos θ)/θ² and b = (θ − sin θ)/θ³ (T. Barfoot, State
    Estimation for Robotics (2017), eq. 7.77).
    """
    square = (vectors**2).sum(axis=-1)
    angle = np.sqrt(square)
    small = angle < SMALL_TURN_RAD
    by = np.where(small, 1.0, angle)
    a = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    series = 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))
    b = np.where(small, series, (by - np.sin(by)) / by**3)
    crossed = skew(vectors)
    left = np.eye(3) + a[..., None, None] * crossed + b[..., None, None] * (crossed @ crossed)
    return np.eye(3) + crossed @ left, left


def quaternion_of(rotations: Array) -> Array:
    """(…, 4) unit quaternions (x, y, z, w) of rotation matrices (…, 3, 3), their largest components positive.

    All products q_i q_j of its components are sums of the matrix's elements; the row of the largest q_i is that of most
    digits (S. W. Shepperd, J. Guidance and Control 1, 1978, 223-224).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.moveaxis(rotations, (-2, -1), (0, 1))
    trace = xx + yy + zz
    products = (  # 4 q_i q_j
        (1.0 - trace + 2.0 * xx, xy + yx, xz + zx, zy - yz),
        (xy + yx, 1.0 - trace + 2.0 * yy, yz + zy, xz - zx),
        (xz + zx, yz + zy, 1.0 - trace + 2.0 * zz, yx - xy),
        (zy - yz, xz - zx, yx - xy, 1.0 + trace),
    )
    largest = np.argmax((xx, yy, zz, trace), axis=0)
    rows = np.moveaxis(np.choose(largest, np.array(products)), 0, -1)
    return np.asarray(rows / np.linalg.norm(rows, axis=-1, keepdims=True))


def nearest_rotations(matrices: Array) -> Array:
    """(…, 3, 3) proper rotations nearest to matrices (…, 3, 3) (Wahba's problem, SVD solution of Markley 1988)."""
    u, _, vt = np.linalg.svd(matrices)
    u[..., 2] *= np.linalg.det(u @ vt)[..., None]
    return np.asarray(u @ vt)


def travel_by_turn(u: Array, w: Array) -> Array:
    """(3, 3) derivative of the travel of a screw motion exp(u, w) by its turn w, in the axes that it ends in.

    T. Barfoot, State Estimation for Robotics (2017), eq. 7.86, of (−u, −w); for small turns by its series, since the
    closed form loses nine digits there.

    Args:
        u: (3,) linear part.
        w: (3,) turn, rad.
    """
    t2 = float(w @ w)
    t = math.sqrt(t2)
    if t > SMALL_TURN_RAD:
        s, c = math.sin(t), math.cos(t)
        c1 = (t - s) / t**3
        c2 = (t2 + 2.0 * c - 2.0) / (2.0 * t**4)
        c3 = (2.0 * t - 3.0 * s + t * c) / (2.0 * t**5)
    else:
        c1 = 1.0 / 6.0 - t2 / 120.0 * (1.0 - t2 / 42.0 * (1.0 - t2 / 72.0))
        c2 = 1.0 / 24.0 - t2 / 720.0 * (1.0 - t2 / 56.0 * (1.0 - t2 / 90.0))
        c3 = 1.0 / 120.0 - t2 / 2520.0 * (1.0 - t2 / 48.0 * (1.0 - t2 * 7.0 / 550.0))
    # With W = [−w]×, U = [−u]×: WU + UW = wuᵀ + uwᵀ − 2d I, WUW = −d W, W²U + UW² = −t² U − d W.
    d = float(w @ u)
    x, y, z = ((0.5 - c2 * t2) * u + (2.0 * c2 - c1) * d * w).tolist()
    crossed = np.outer(w, c1 * u - c3 * d * w)
    found = crossed + crossed.T + np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    found[_DIAGONAL] += 2.0 * d * (c3 * t2 - c1)
    return np.asarray(found)
