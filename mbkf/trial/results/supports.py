"""Loads on other parts of the body than the feet, and where on those parts they act."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.record import Track
from mbkf.io.contacts import FEET, ContactInterval
from mbkf.io.result_groups import SupportLoads
from mbkf.model.body import Body
from mbkf.sensors.supports.bearings import BearingParts

MOST_LISTED = 6
"""Number of loads that are listed with their times."""

LEAST_N = 20.0
"""Size of a force from which it has a point where it acts."""


def supports_of(model: Body, track: Track) -> SupportLoads:
    """Loads on other parts than the feet of a tracked trial; NaN where it is not started.

    Before the first contact of a causal run has opened only feet bear.
    """
    if not np.isfinite(track.support).any():
        return support_loads((), np.zeros((len(track.q), 0, 6)))
    parts = BearingParts(model)
    followed = np.isfinite(track.q).all(axis=1)
    narrow = np.isnan(track.support) & np.asarray(followed)[:, None, None]
    support, support_sd = (np.where(narrow, 0.0, one) for one in (track.support, track.support_sd))
    point_m = np.full((*support.shape[:2], 3), np.nan)
    for t in np.flatnonzero(np.nan_to_num(support).any(axis=(1, 2))):
        point_m[t] = pressed_points(parts, track.q[t], support[t])
    return support_loads(parts.names, support, support_sd, point_m)


def support_loads(
    names: tuple[str, ...], wrench: Array, wrench_sd: Array | None = None, point_m: Array | None = None
) -> SupportLoads:
    """Loads on parts.

    Args:
        names: The B parts.
        wrench: (T, B, 6) on each.
        wrench_sd: (T, B, 6) standard deviations; NaN by default.
        point_m: (T, B, 3) where the force acts; NaN by default.
    """
    unknown = np.full(wrench.shape, np.nan)
    return SupportLoads(
        support_names=names,
        support_wrench=wrench,
        support_wrench_sd=unknown if wrench_sd is None else wrench_sd,
        support_point_m=unknown[..., :3] if point_m is None else point_m,
    )


def pressed_points(parts: BearingParts, q: Array, wrench: Array) -> Array:
    """(B, 3) where loads act on parts: NaN where a part bears less than :data:`LEAST_N`.

    A wrench with force F and moment M about a part's middle has its axis (of least moment) nearest to the middle at
    F × M / F²; from there the point goes back against the force to the part's surface.

    Args:
        parts: The parts.
        q: (nq,) configuration.
        wrench: (B, 6) wrenches about the world's origin.
    """
    middles, force = parts.at(q, np.zeros(parts.model.nv)).points_m, wrench[:, :3]
    size = np.linalg.norm(force, axis=1)
    divided = np.where(size >= LEAST_N, size, np.nan)[:, None]
    moment = wrench[:, 3:] - np.cross(middles, force)
    return np.asarray(
        middles + np.cross(force, moment) / divided**2 - parts.radii_m[:, None] * force / divided
    )


def supports_remarks(contacts: Sequence[ContactInterval]) -> tuple[str, ...]:
    """Remarks on loads on other parts than the feet, with times and forces; empty without such loads."""
    others = [one for one in contacts if one.part not in FEET]
    if not others:
        return ()
    listed = [
        f"{one.part.replace('_', ' ')} {one.from_s:.2f}…{one.to_s:.2f} s (up to {one.peak_n:.0f} N)"
        for one in others[:MOST_LISTED]
    ]
    rest = f" and {len(others) - MOST_LISTED} more" if len(others) > MOST_LISTED else ""
    return (f"other parts than the feet bear load, estimated from the motion: {', '.join(listed)}{rest}",)
