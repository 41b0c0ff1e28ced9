"""Times at which a magnetometer sees another field than usual: iron or a magnet is near."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.printed import percent
from mbkf.numerics.runs import runs

SIZE_SHARE, DIP_RAD = 0.2, 0.26
"""A field that differs from the usual one by more, in size or dip, is disturbed."""

MEAN_S, SHORTEST_S = 0.5, 1.0
"""Averaging time; shorter disturbances are not reported."""


def field_remarks(one: ImuReadings, quaternion: Array) -> tuple[str, ...]:
    """A remark on the times at which a sensor's field is disturbed; empty without disturbance.

    Args:
        one: Its readings.
        quaternion: (T, 4) its orientation, sensor → a world whose z is up; NaN where unknown.
    """
    if one.magnetic_field is None:
        return ()
    size, dip = size_and_dip(one.magnetic_field, quaternion)
    known = np.isfinite(size) & np.isfinite(dip)
    if not known.any():
        return ()
    usual_size, usual_dip = np.median(size[known]), np.median(dip[known])
    off_size, off_dip = size / usual_size - 1.0, dip - usual_dip
    disturbed = np.maximum(np.abs(off_size) / SIZE_SHARE, np.abs(off_dip) / DIP_RAD)
    window = max(1, round(MEAN_S * one.rate_hz))
    mean = np.convolve(np.where(known, disturbed, 0.0), np.ones(window) / window, mode="same")
    long = [(a, b) for a, b in runs(mean > 1.0) if b - a >= SHORTEST_S * one.rate_hz]
    if not long:
        return ()
    share = sum(b - a for a, b in long) / one.samples
    times = ", ".join(f"{one.time_s[a]:.0f} to {one.time_s[b - 1]:.0f} s" for a, b in long[:3])
    more = f" and {len(long) - 3} times more" if len(long) > 3 else ""
    worst_size = max((off_size[a:b][known[a:b]] for a, b in long), key=lambda x: np.abs(x).max(initial=0.0))
    worst_dip = max((off_dip[a:b][known[a:b]] for a, b in long), key=lambda x: np.abs(x).max(initial=0.0))
    return (
        f"sensor {one.name}: its magnetic field is disturbed in {percent(share)} of the time ({times}{more}): "
        f"its size by up to {percent(np.abs(worst_size).max(initial=0.0))}, its dip by up to "
        f"{np.degrees(np.abs(worst_dip).max(initial=0.0)):.0f} deg; the heading is less sure then",
    )


def size_and_dip(field_ut: Array, quaternion: Array) -> tuple[Array, Array]:
    """Size (T,), µT, and dip (T,), rad, of fields (T, 3) in sensor axes, turned by (T, 4) into a world with z up."""
    turned = (quaternion_matrices(quaternion) @ field_ut[:, :, None])[:, :, 0]
    return np.linalg.norm(field_ut, axis=1), np.arctan2(turned[:, 2], np.hypot(turned[:, 0], turned[:, 1]))
