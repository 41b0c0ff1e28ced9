"""A foot that carries weight does not slide: what is known of a loaded foot while none of its markers is seen.

The point under the centre of pressure stands still, whether the foot is flat or rolls; a flat foot does not turn
either. Read as zero velocity; its derivative by the configuration vanishes where the reading is met.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel
from mbkf.sensors.contacts import FEET


class Planted(NamedTuple):
    """A standing foot: 0 right or 1 left, the world point (3,) that stands still, and whether the foot lies flat."""

    foot: int
    point_m: Array
    flat: bool


def standing_still(
    model: HumanModel, q: Array, v: Array, planted: Planted, speed_sd: float, turn_sd: float
) -> tuple[Array, Array]:
    """Whitened rows (k, nv) on the velocity and their innovations (k,): three, and three more for a flat foot.

    Args:
        model: The body.
        q: (nq,) configuration.
        v: (nv,) velocity.
        planted: The foot.
        speed_sd: How still the point stands, m/s.
        turn_sd: How little a flat foot turns, rad/s.
    """
    jacobian = model.segment_jacobian(q, FEET[planted.foot], planted.point_m)
    weight = 1.0 / np.repeat([speed_sd, turn_sd], 3)
    rows = (weight[:, None] * jacobian)[: 6 if planted.flat else 3]
    return rows, -rows @ v
