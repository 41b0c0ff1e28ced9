"""Possible readings of a plate under a person of known mass, judged sample by sample.

With the vertical force F_z, the shear F_h and the moments M about the plate's origin, of a person who weighs W:

    F_z ≤ 20 W,   F_z ≥ −0.3 W,   |F_h| ≤ 3 (F_z + 0.4 W),   |M_h| ≤ r (F_z + 0.4 W),   |M_z| ≤ 3 r (F_z + 0.4 W)

r is the largest distance from the origin at which a foot can press. Each limit is a convex set, so that the straight
line between two possible readings is possible, too. A live stream refuses the same samples as a whole trial.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.records import PlateReadings
from mbkf.kernel.contact_functions import PossibleLoads
from mbkf.kernel.loading import library

MOST_WEIGHTS = 20.0
"""Largest vertical force, body weights. The hardest known contact, the step of a triple jump, reaches 15.2 (Perttunen
et al. 2000); sprinting 4 to 5, landing from a height up to some 11."""

PULL_WEIGHTS = 0.3
"""A plate cannot pull; it may ring after a landing, and show the remainder of its offset."""

FRICTION = 3.0
"""Largest shear over vertical force: twice that of rubber on rubber, for spikes and starting blocks."""

SLACK_WEIGHTS = 0.4
"""Body weights added to the vertical force that limits shear and moments: at touch-down shear comes early, and a hardly
loaded plate reads noise."""

BEYOND_M = 0.5
"""Largest distance of a foot's centre of pressure outside its plate."""

ANYWHERE_M = 20.0
"""Largest distance from the origin on a plate without an outline, which may be a whole walkway."""


class Fault(IntEnum):
    """Fault of a plate's sample; 0 for a good one."""

    NONE = 0
    NOT_A_NUMBER = 1
    FORCE = 2
    PULL = 3
    SHEAR = 4
    MOMENT = 5
    SPIKE = 6
    DROPOUT = 7
    SATURATED = 8
    STUCK = 9
    SIGN = 10
    GAIN = 11


Faults = NDArray[np.int8]
"""A :class:`Fault` per sample."""


def reaches(plates: Sequence[PlateReadings]) -> Array:
    """(K,) largest distance from each plate's origin at which a foot can press, m."""
    found = [ANYWHERE_M] * len(plates)
    for k, plate in enumerate(plates):
        if plate.corners_m is not None:
            found[k] = BEYOND_M + float(np.linalg.norm(plate.corners_m - plate.origin_m, axis=1).max())
    return np.array(found)


def impossible(wrench: Array, weight_n: float, reach_m: float | Array) -> Faults:
    """Faults of samples by their values alone.

    Args:
        wrench: (..., 6) force N and moment N m about the plate's origin, world axes.
        weight_n: The person's weight.
        reach_m: :func:`reaches`; a number, or one per plate that broadcasts.

    Returns:
        (...) the first limit that each sample breaks, or :attr:`Fault.NONE`.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        vertical = wrench[..., 2]
        least = np.maximum(vertical + SLACK_WEIGHTS * weight_n, 0.0)
        kinds = (
            (Fault.MOMENT, np.abs(wrench[..., 5]) > FRICTION * reach_m * least),
            (Fault.MOMENT, np.hypot(wrench[..., 3], wrench[..., 4]) > reach_m * least),
            (Fault.SHEAR, np.hypot(wrench[..., 0], wrench[..., 1]) > FRICTION * least),
            (Fault.PULL, vertical < -PULL_WEIGHTS * weight_n),
            (Fault.FORCE, np.abs(vertical) > MOST_WEIGHTS * weight_n),
            (Fault.NOT_A_NUMBER, ~np.isfinite(wrench).all(axis=-1)),
        )
    faults = np.zeros(wrench.shape[:-1], dtype=np.int8)
    for kind, breaks in kinds:
        faults[breaks] = kind
    return faults


def all_possible(readings: Array, weight_n: float, reach_m: Array) -> bool:
    """True if no reading breaks a limit of :func:`impossible`.

    Args:
        readings: (..., K, 6) force N and moment N m about the plates' origins, world axes.
        weight_n: The person's weight.
        reach_m: (K,) :func:`reaches`.
    """
    kernel = library()
    if kernel is None:
        return not impossible(readings, weight_n, reach_m).any()
    return kernel.wrenches_possible(np.ascontiguousarray(readings), reach_m, _limits(weight_n))


@lru_cache(maxsize=16)
def _limits(weight_n: float) -> PossibleLoads:
    return PossibleLoads(
        weight_n=weight_n, most=MOST_WEIGHTS, pull=PULL_WEIGHTS, friction=FRICTION, slack=SLACK_WEIGHTS
    )


def without_impossible(wrench: Array, plates: Sequence[PlateReadings], weight_n: float) -> Array:
    """Readings of a frame with NaN for plates whose reading is impossible.

    Args:
        wrench: (K, 6) force N and moment N m about the world's origin.
        plates: The K plates; only their places are used.
        weight_n: The person's weight.
    """
    own = wrench.copy()
    origins = np.array([plate.origin_m for plate in plates]).reshape(-1, 3)
    with np.errstate(invalid="ignore", over="ignore"):
        own[:, 3:] -= np.cross(origins, wrench[:, :3])
    bad = impossible(own, weight_n, reaches(plates)) != Fault.NONE
    return np.where(bad[:, None], np.nan, wrench)
