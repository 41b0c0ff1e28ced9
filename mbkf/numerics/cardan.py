"""Cardan (Tait–Bryan) angles of rotations, their rates and their continuation through the singularity.

R = R_i(a) R_j(b) R_k(c) about three different axes i, j, k. Everything here is written in the basis (i, j, k)
itself: R_ijk[m, n] = R[ijk[m], ijk[n]], and ε = +1 where (i, j, k) is an even permutation of (x, y, z), else
    −1. Many rotations are handled at once; their leading axes and ε broadcast.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray

SINGULAR_MARGIN_RAD = np.deg2rad(10.0)
"""Angles count as singular where the second one is within this of ±90°."""

UPRIGHT_COSINE = 0.5
"""The principal angles hold where the third axis leans less than 60° from its own rest direction."""

SHORTEST = 0.5
"""A quaternion shorter than this, or longer than 1 / this, is not a rotation that was rounded."""

_LEAST_COSINE = 1e-9


def unit_quaternions(quaternions: Array) -> Array:
    """Quaternions (…, 4) of length 1; NaN for those that are not rotations (:data:`SHORTEST`)."""
    size = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    valid = (size > SHORTEST) & (size < 1.0 / SHORTEST)
    return np.divide(quaternions, size, out=np.full(np.shape(quaternions), np.nan), where=valid)


def quaternion_matrices(quaternions: Array) -> Array:
    """(…, 3, 3) rotation matrices of unit quaternions (…, 4) in (x, y, z, w) order."""
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, -1) for row in rows], -2)


def rotation_matrix(quaternion: Array) -> Array:
    """(3, 3) rotation matrix of a unit quaternion (4,) in (x, y, z, w) order; quicker for a single one."""
    x, y, z, w = quaternion.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def cardan_angles(R_ijk: Array, parity: Array) -> Array:
    """Principal angles (…, 3) with |b| ≤ 90°, rad, of rotations (…, 3, 3) with ε ``parity`` (…)."""
    a = np.arctan2(-parity * R_ijk[..., 1, 2], R_ijk[..., 2, 2])
    cosine_b = np.hypot(R_ijk[..., 0, 0], R_ijk[..., 0, 1])
    b = np.arctan2(parity * R_ijk[..., 0, 2], cosine_b)
    c = np.arctan2(-parity * R_ijk[..., 0, 1], R_ijk[..., 0, 0])
    return np.stack([a, b, c], -1)


def velocity_map(angles: Array, parity: Array) -> Array:
    """B (…, 3, 3) of ω = B θ̇: body-frame angular velocity in the basis (i, j, k) from the rates of (a, b, c).

    Regular everywhere; its transpose takes a moment to the generalised moments conjugate to the angles.
    """
    b, c = angles[..., 1], angles[..., 2]
    zero, one = np.zeros_like(b), np.ones_like(b)
    cos_b, sin_b, cos_c, sin_c = np.cos(b), parity * np.sin(b), np.cos(c), parity * np.sin(c)
    rows = ((cos_b * cos_c, sin_c, zero), (-cos_b * sin_c, cos_c, zero), (sin_b, zero, one))
    return np.stack([np.stack(row, -1) for row in rows], -2)


def rate_map(angles: Array, parity: Array) -> Array:
    """E = B⁻¹ (…, 3, 3) of θ̇ = E ω; at the singularity itself, where it is infinite, a very large matrix."""
    b, c = angles[..., 1], angles[..., 2]
    zero, one = np.zeros_like(b), np.ones_like(b)
    cos_b = np.cos(b)
    cos_b = np.where(np.abs(cos_b) < _LEAST_COSINE, np.copysign(_LEAST_COSINE, cos_b), cos_b)
    cos_c, sin_c, tan_b = np.cos(c), parity * np.sin(c), parity * np.sin(b) / cos_b
    rows = (
        (cos_c / cos_b, -sin_c / cos_b, zero),
        (sin_c, cos_c, zero),
        (-tan_b * cos_c, tan_b * sin_c, one),
    )
    return np.stack([np.stack(row, -1) for row in rows], -2)


def near_singularity(angles: Array) -> BoolArray:
    """(…) True where a and c are poorly determined: b within 10° of ±90°."""
    with np.errstate(invalid="ignore"):
        return np.abs(np.cos(angles[..., 1])) < np.sin(SINGULAR_MARGIN_RAD)


def follow(principal: Array, winds: BoolArray, start: Array | None = None) -> Array:
    """Angles that continue in time, of the two sets (a, b, c), (a + π, π − b, c + π) of the same rotation.

    A joint that is lifted through b = 90° keeps all three angles continuous. Back near its rest posture
    (third axis within 60° of it) the principal angles hold again, so that one bad frame at the singularity
    does no lasting harm.

    Args:
        principal: (T, n, 3) principal angles, rad; NaN where missing.
        winds: (n,) True for a rotation that may turn round and round (the root), False for a joint.
        start: (n, 3) angles before the first frame; NaN, or None, where there are none.

    Returns:
        (T, n, 3) angles, rad; NaN where missing.
    """
    turned = np.array([1.0, -1.0, 1.0]) * principal + np.pi
    upright = np.cos(principal[..., 0]) * np.cos(principal[..., 1]) > UPRIGHT_COSINE
    home = upright & (np.cos(principal[..., 2]) > 0.0) & ~winds
    last = np.full(principal.shape[1:], np.nan) if start is None else np.array(start, dtype=float)
    last = np.where(np.isnan(last), _first_finite(principal), last)
    if len(principal) == 1:
        return _continued(principal, turned, upright, home, last[None])
    # Up to the first frame in which they differ, principal angles continue themselves.
    own = _continued(principal, turned, upright, home, _before(principal, last))
    differs = ~((own == principal) | np.isnan(principal)).all(axis=-1)
    followed = np.array(principal)
    for joint in np.flatnonzero(differs.any(axis=0)):
        first, mine = int(differs[:, joint].argmax()), slice(joint, joint + 1)
        held = _before(principal[: first + 1, mine], last[mine])[-1]
        for t in range(first, len(principal)):
            now = _continued(principal[t, mine], turned[t, mine], upright[t, mine], home[t, mine], held)
            followed[t, mine] = now
            held = np.where(np.isnan(now), held, now)
    return followed


def _continued(principal: Array, turned: Array, upright: BoolArray, home: BoolArray, last: Array) -> Array:
    """(…, 3) the set of angles nearest to those before, and principal ones near a joint's rest posture.

    Args:
        principal: (…, 3) principal angles.
        turned: (…, 3) the other set of the same rotation.
        upright: (…,) third axis near that of the rest posture.
        home: (…,) near the rest posture.
        last: (…, 3) angles before.
    """
    own, other = _nearest_turn(principal, last), _nearest_turn(turned, last)
    closer = ((other - last) ** 2).sum(-1) < ((own - last) ** 2).sum(-1)
    own = np.where((closer & ~upright)[..., None], other, own)
    return np.where(home[..., None], principal, own)


def _before(series: Array, start: Array) -> Array:
    """(T, n, 3) the latest known values before each frame of a series, ``start`` (n, 3) where there are none."""
    known = np.isfinite(series[:-1])
    latest = np.zeros(series.shape, dtype=int)
    frames = np.arange(1, len(series))[:, None, None]
    latest[1:] = np.maximum.accumulate(np.where(known, frames, 0), axis=0)
    return np.take_along_axis(np.concatenate([start[None], series]), latest, axis=0)


def _nearest_turn(angles: Array, near: Array) -> Array:
    return angles + 2.0 * np.pi * np.round((near - angles) / (2.0 * np.pi))


def _first_finite(series: Array) -> Array:
    """(n, 3) first finite sample along time, NaN where there is none."""
    finite = np.isfinite(series)
    if not len(series):
        return np.full(series.shape[1:], np.nan)
    return np.take_along_axis(series, finite.argmax(axis=0)[None], axis=0)[0]
