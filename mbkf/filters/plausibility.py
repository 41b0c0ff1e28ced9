"""Bounds on estimates: finite numbers, joint rates and ground forces that bodies can have.

Readings that contradict each other (a plate in other units, of another person, of another time) may drive a filter or a
smoother to numbers that solve its equations and are no motion. Newton's law is not linear: a smoother, which follows
linearisations back in time, leaves the possible states earlier and further than the filter does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.estimate import Posterior
from mbkf.kernel.loading import library
from mbkf.model.body import Body
from mbkf.model.motion_frames import motion_frames
from mbkf.sensors.contact.possible import MOST_WEIGHTS
from mbkf.sensors.gating import TRACK_LOSS_M

MOST_RAD_S = 300.0
"""No joint turns faster, rad/s. The fastest that is known, the shoulder of a pitcher, reaches 126 in the mean of
professionals (Fleisig 1999: 7,240°/s)."""

DOUBT = 2.0
"""An estimated force may exceed the largest known one, :data:`mbkf.sensors.contact.possible.MOST_WEIGHTS`, by this."""


def plausible(estimate: Posterior, model: Body) -> bool:
    """True where an estimate is finite, no joint turns faster than :data:`MOST_RAD_S`, and forces can be borne."""
    q, v, a = estimate.q, estimate.v, estimate.a
    most = DOUBT * MOST_WEIGHTS * GRAVITY_M_S2 * model.mass_kg
    kernel = library()
    if kernel is not None:
        read = np.ascontiguousarray
        return kernel.is_possible(read(q), read(v), read(a), read(estimate.wrench), MOST_RAD_S, most)
    if not isfinite(float(q @ q) + float(a @ a)):
        return False
    if not (v.max(initial=0.0) <= MOST_RAD_S and v.min(initial=0.0) >= -MOST_RAD_S):  # NaN is not
        return False
    return not any(abs(force) > most for force in estimate.wrench[:, :3].ravel().tolist())


def moved_away(filtered: Sequence[Posterior], smoothed: Sequence[Posterior], model: Body) -> bool:
    """True where smoothing moves most joints further than a track may be off, though markers showed the body at once.

    Args:
        filtered: The filter's own estimates.
        smoothed: The estimates in the light of later frames, as many.
        model: The body.
    """
    pairs = [
        (own, later)
        for own, later in zip(filtered, smoothed, strict=True)
        if own.tracked and own.placed and not own.started
    ]
    if not pairs:
        return False
    q = np.array([[one.q for one in pair] for pair in pairs]).swapaxes(0, 1)
    before_m, after_m = (motion_frames(model, of_all)[0][:, :, 3] for of_all in q)
    moved = np.linalg.norm(after_m - before_m, axis=-1) > TRACK_LOSS_M
    return bool((2 * np.count_nonzero(moved, axis=1) > moved.shape[1]).any())


def smoothed_or_filtered(
    filtered: Sequence[Posterior], smooth: Callable[[], Sequence[Posterior]], model: Body
) -> list[Posterior]:
    """Smoothed estimates; where one of them is implausible, the filtered ones, marked as ``uncorrected``.

    Args:
        filtered: The filter's estimates.
        smooth: Makes the smoothed ones, as many.
        model: The body.
    """
    try:
        with np.errstate(all="ignore"):  # the result is checked
            found = list(smooth())
            if all(plausible(one, model) for one in found) and not moved_away(filtered, found, model):
                return found
    except np.linalg.LinAlgError:
        pass
    return [one._replace(uncorrected=True) for one in filtered]
