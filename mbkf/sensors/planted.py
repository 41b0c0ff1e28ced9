"""A foot that carries weight does not slide: what is known of a loaded foot while none of its markers is seen.

The point under the centre of pressure stands still, whether the foot is flat or rolls; a flat foot does not turn
either, nor do the toes once the load is on them and the heel rises. Read as zero velocity; its derivative by the
configuration vanishes where the reading is met.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel


class Planted(NamedTuple):
    """What stands: a foot or its toes, the world point (3,) of it that does not move, and whether it lies flat."""

    segment: str
    point_m: Array
    flat: bool


def standing_still(
    model: HumanModel, q: Array, v: Array, planted: Planted, speed_sd: float, turn_sd: float
) -> tuple[Array, Array]:
    """Whitened rows (k, nv) on the velocity and their innovations (k,): three, and three more for what lies flat.

    Args:
        model: The body.
        q: (nq,) configuration.
        v: (nv,) velocity.
        planted: The foot or its toes.
        speed_sd: How still the point stands, m/s.
        turn_sd: How little what lies flat turns, rad/s.
    """
    jacobian = model.segment_jacobian(q, planted.segment, planted.point_m)
    weight = 1.0 / np.repeat([speed_sd, turn_sd], 3)
    rows = (weight[:, None] * jacobian)[: 6 if planted.flat else 3]
    return rows, -rows @ v
