"""Stances of two feet together: on one plate, which reads their sum, or on floor that no plate reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.sensors.contact.records import FreeStance
from mbkf.sensors.contact.rules import BOTH
from mbkf.sensors.contact.sharing import SharedLoad, expected_stance, push_share, share_load
from mbkf.sensors.contact.soles import Sole


def shared_between(
    soles: Sequence[Sole],
    pelvis_m: Sequence[float],
    plate_wrench: Array,
    foot_of_plate: Sequence[int],
    surfaces_m: Sequence[float],
) -> SharedLoad:
    """Load of all plates under the feet, shared between them.

    Args:
        soles: Heel, ball and toe end of right and left sole.
        pelvis_m: The pelvis, x, y, z.
        plate_wrench: (K, 6) force N and moment N m about the world's origin.
        foot_of_plate: (K,) foot of each plate; one of them is both.
        surfaces_m: (K,) heights of the plates.
    """
    under = [k for k, owner in enumerate(foot_of_plate) if owner >= 0]
    surface = surfaces_m[foot_of_plate.index(BOTH)]
    return share_load(plate_wrench[under].sum(axis=0), soles, np.array(pelvis_m), surface)


def free_stance(
    soles: Sequence[Sole],
    pelvis_m: Sequence[float],
    lowest_ball_m: Sequence[float],
    touching_s: Sequence[float],
) -> FreeStance:
    """Stance of both feet on floor that no plate reads.

    Args:
        soles: Heel, ball and toe end of right and left sole.
        pelvis_m: The pelvis, x, y, z.
        lowest_ball_m: Least height of each ball while the foot has stood.
        touching_s: Duration for which each foot has stood.
    """
    surface = min(point[2] for sole in soles for point in sole)
    right, left = (push_share(soles[f], lowest_ball_m[f], touching_s[f]) for f in (0, 1))
    return FreeStance(expected_stance(soles, surface), np.array(pelvis_m), (right, left))
