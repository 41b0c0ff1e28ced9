"""The rules of contact between feet, plates and floor: each limit with its reason, each rule as a predicate.

    1  a plate is loaded        its vertical force reaches its threshold                          is_loaded
    2  a foot is on a plate     the centre of pressure is near its sole, nearer than to the other  nearer_foot
    3  both are on one plate    their lowest points lie over it, level and at rest to each other   stand_together
    4  a foot touches           a sole point is low and slow, and the sole faces down              Touch, faces_down
    5  a foot carries nothing   an unloaded plate lies under the middle of its sole                PlateAreas.over
    6  the body falls           nothing supports the vertical acceleration of its pelvis           falls
    7  the lower foot stands    under a body that does not fall, whatever else is known            lower_feet

Causal detection (:mod:`.causal`, :mod:`.unmeasured`, :mod:`.floor`) applies the rules to the predicted motion of one
frame; an error disturbs the filter at once. The compiled kernel (``contact.c``) repeats it with the same limits.
Offline assignment (:mod:`.offline`) applies the rules to a whole tracked trial and only refuses frames whose reactions
are not fully measured. Where the two differ, both limits stand here with the reason. Predicates take numbers or arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.kernel.contact_functions import ContactLimits

RIGHT, LEFT, BOTH, NEITHER = 0, 1, 2, -1
"""Foot to which a plate belongs."""

SOLE_ENDS = 2
"""Causal: points of a sole that give its height, heel and ball. The toe end dips below the floor when the toes bend,
and the learnt floor would follow. Offline, touching looks at all three; its floor is a median over the trial."""

# 1 and 2: plates and feet.

REACH_M = 0.20
"""A centre of pressure farther than this from a sole belongs to no foot. It allows for the width of a foot and
for soles and plates that disagree by centimetres."""

KEEP_M = 0.04
"""Causal: a plate stays with its foot until the other sole is nearer by this. Offline, the whole stretch of loading
decides instead."""

MAJORITY_S = 0.05
MIXED_SHARE = 0.2
"""Offline: where more than this share of a stretch of loading is nearer to the other sole, the plate changes feet
within the stretch, and each frame follows the majority of the frames up to so much earlier and later."""


def least_load(threshold_n: float) -> float:
    """Vertical force from which a plate counts as loaded, N: its threshold, or any force upwards."""
    return max(threshold_n, float(np.finfo(float).tiny))


def nearer_foot(away_m: Sequence[float], before: int = NEITHER) -> int:
    """Foot to which a centre of pressure belongs.

    Args:
        away_m: Distance from the right and from the left sole.
        before: The foot it belonged to, which keeps it unless the other one is clearly nearer.
    """
    nearest = RIGHT if away_m[RIGHT] <= away_m[LEFT] else LEFT
    if before in (RIGHT, LEFT) and away_m[before] <= away_m[nearest] + KEEP_M:
        nearest = before
    return nearest if away_m[nearest] <= REACH_M else NEITHER


def swings_over(speed_m_s: float, keeper_m_s: float) -> bool:
    """True for a foot that swings over a plate on which the other stands: causally, the plate stays with that one.

    Where feet cross or pass close to each other, the sole that swings comes nearer to the centre of pressure.

    Args:
        speed_m_s: Speed of its sole's lowest point against the floor.
        keeper_m_s: That of the foot that the plate belonged to in the frame before.
    """
    return speed_m_s > keeper_m_s + PARTED_M_S


# 3: two feet on one plate.

LEVEL_M = 0.09
PARTED_M_S = 1.2
"""Two feet stand on one plate while the lowest points of their soles are level to this (toes that bend dip into the
floor by 40 mm, a landing heel is above it by as much), and move so slowly against each other: on a belt both move, a
foot that swings is faster by 3 m/s."""

LEAVE_SLACK = 1.7
"""Causal: factor on the limits of a foot that stood and has to leave the floor, and of two feet that shared a plate and
have to part. The hysteresis keeps decisions from alternating between frames."""


def stand_together(rise_m: float | Array, speed_m_s: float | Array, slack: float = 1.0) -> bool | BoolArray:
    """True where the lowest points of both soles, which lie over one plate, are level and at rest to each other.

    Args:
        rise_m: Height of one point above the other.
        speed_m_s: Speed of one against the other.
        slack: :data:`LEAVE_SLACK` for feet that stood together in the frame before.
    """
    return (rise_m > -LEVEL_M) & (rise_m < LEVEL_M) & (speed_m_s < slack * PARTED_M_S)


# 4: feet that touch.


class Touch(NamedTuple):
    """Limits of a sole point that touches the floor: its height above the floor and its speed against it."""

    height_m: float
    speed_m_s: float

    def relaxed(self) -> Touch:
        """The limits of a foot that stood in the frame before."""
        return Touch(LEAVE_SLACK * self.height_m, LEAVE_SLACK * self.speed_m_s)

    def holds(self, height_m: float | Array, floor_m: float, speed_m_s: float | Array) -> bool | BoolArray:
        """True where a point is low and slow; never for a floor of unknown height (NaN).

        Args:
            height_m: Height of the point.
            floor_m: Height of the floor.
            speed_m_s: Speed of the point against the floor.
        """
        return (height_m < floor_m + self.height_m) & (speed_m_s < self.speed_m_s)

    def nearness(self, height_m: float, floor_m: float, speed_m_s: float) -> float:
        """1 for a point at rest on the floor, falling as a Gaussian of the limits.

        Args:
            height_m: Height of the point.
            floor_m: Height of the floor.
            speed_m_s: Speed of the point against the floor.
        """
        high, fast = max(height_m - floor_m, 0.0) / self.height_m, speed_m_s / self.speed_m_s
        return exp(-0.5 * (high**2 + fast**2))


TOUCHING = Touch(0.025, 0.4)
"""Offline. Strict, and without delay, because a touching foot without a plate only invalidates its frame."""

STANDING = Touch(0.045, 0.8)
STAND_AFTER_S = 0.025
"""Causal: a foot that touches for that long carries weight, unless a plate below it reads nothing. The limits are wider
than offline, since a landing heel is pitched and touches above the level of a flat sole, and since a foot held to be in
the air would be denied its reaction. The delay gives the foot's plate time to read first."""

STANDING_ALONE = Touch(0.06, 3.0)
"""Causal: the limits where nothing else carries the body: a runner lands on a foot that is still that fast against the
floor. Held to be in the air, it would make the body fall; held to bear too early, it is found to carry nothing."""

FACES_DOWN = 0.25
"""Cosine of a sole's tilt from level below which nobody stands on it: feet push off at up to 65°, a kneeling foot on
its toes or its instep is tilted by more than 80°."""

FLAT_FROM, FLAT_TO = 0.1, 0.6
"""Causal: a foot whose load lies between these shares of its sole, from heel to toe end, lies flat."""

FLOOR_SHARE = 0.1
"""Causal: share by which the floor's height under a loaded foot is corrected per frame."""

FLOOR_PERCENTILE = 5.0
"""Offline: without a loaded frame, the floor lies at this percentile of the sole's lowest heights."""

BELT_WINDOW_S = 1.0
STILL_FLOOR_S = 0.1
BELT_FROM_M_S = 0.4
"""Causal: the floor's velocity is the median of the low sole points' over the last second, with a tenth of a second's
worth of a floor that stands still, and 0 below the last limit, a speed that standing feet reach anyway."""


# 6 and 7: flight.

FALL_M_S2 = -0.4 * GRAVITY_M_S2
"""Vertical acceleration of the pelvis below which nothing carries the body. The limit lies between full gravity, with
which a body in flight falls, and the acceleration of a body on legs. The causal decision takes the predicted
acceleration, the offline assignment the curvature of the pelvis's height."""

FALL_WINDOW_S = 0.07
"""Duration over which that curvature is fitted; long enough for the noise of a differentiated height. Causal: a fall
that has been predicted for that long has to show in it."""

FALL_EDGE_S = 0.02
"""Offline: flight begins and ends this much earlier and later, as the window blurs its edges."""

LOWER_M = 0.025
"""Causal: soles within this height of each other are level, and both carry a body that does not fall."""

STANDING_SHARE = 0.05
"""Offline: share of body weight that the plates must carry for a frame outside flight to be fully measured."""


def falls(acceleration_m_s2: float | Array) -> bool | BoolArray:
    """True where nothing carries a body whose pelvis has this vertical acceleration; False for NaN."""
    return acceleration_m_s2 < FALL_M_S2


def lower_feet(heights_m: Sequence[float]) -> list[int]:
    """The lower foot of two by the heights of their soles, or both where they are level."""
    return [f for f in (RIGHT, LEFT) if heights_m[f] <= min(heights_m) + LOWER_M]


LIMITS = ContactLimits(
    reach_m=REACH_M,
    keep_m=KEEP_M,
    belt_from_m_s=BELT_FROM_M_S,
    lower_m=LOWER_M,
    stand_height_m=STANDING.height_m,
    stand_speed_m_s=STANDING.speed_m_s,
    stand_after_s=STAND_AFTER_S,
    alone_height_m=STANDING_ALONE.height_m,
    alone_speed_m_s=STANDING_ALONE.speed_m_s,
    leave_slack=LEAVE_SLACK,
    floor_share=FLOOR_SHARE,
    level_m=LEVEL_M,
    parted_m_s=PARTED_M_S,
    faces_down=FACES_DOWN,
    fall_m_s2=FALL_M_S2,
)
"""Limits of the causal decision as the kernel takes them, by name."""
