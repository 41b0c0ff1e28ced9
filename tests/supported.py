"""True motions on more than the feet, and what plates would give of them, for tests of other contacts."""

import numpy as np

from mbkf.sensors.contact.offline import FootLoads
from mbkf.sensors.supports.bearings import BearingParts
from tests.dynamics import trial

SEAT = 0
"""Place of the pelvis among the parts of the reference body."""


def seated():
    """A person who stands up from a chair."""
    return trial("sit_to_stand")


def seat(motion):
    """(T, 6) true wrench of the seat."""
    return motion.support_wrench.sum(axis=1)


def part(model, name):
    """Place of a part among those of a body."""
    return BearingParts(model).names.index(name)


def middles(model, motion):
    """(T, B, 3) middles of the parts."""
    bearings = BearingParts(model)
    return np.array([bearings.at(q, v).points_m for q, v in zip(motion.q, motion.v, strict=True)])


def foot_loads(wrench, unread=False, floor_m=0.0):
    """What plates that give wrenches (T, 2, 6) to the feet tell; feet beside them if so asked."""
    frames = len(wrench)
    return FootLoads(
        wrench,
        np.full((frames, 2, 3), np.nan),
        np.full((frames, 2), np.nan),
        wrench,
        np.tile([0, 1], (frames, 1)),
        np.full(frames, not unread),
        np.full((frames, 2), unread),
        np.full(frames, True),
        floor_m,
        (),
    )


def carried(motion, points, force):
    """(T, 2, 6) wrenches of the feet when forces (T, 3) act at points (T, 3), too: what these give, feet do not."""
    wrench = motion.foot_wrench.copy()
    wrench[:, 0] -= np.hstack([force, np.cross(points, force)])
    return wrench
