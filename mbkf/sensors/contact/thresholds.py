"""Limits by which contact of the feet with plates and floor is decided, causally and offline.

Both uses share the geometry and the limits below unless a comment gives the reason for a difference. The causal
decision (:mod:`mbkf.sensors.contact.causal`) sees predicted motion and no later frame; what it misses or invents
disturbs the filter at once. The offline assignment (:mod:`mbkf.sensors.contact.offline`) sees the whole tracked trial
and only has to refuse frames whose reactions are not fully measured.
"""

from mbkf.conventions import GRAVITY_M_S2

REACH_M = 0.20
"""A centre of pressure further than this from a sole belongs to no foot. It allows for the width of a foot and
for soles and plates that disagree by centimetres; a load further away is not that of a foot."""

FALL_M_S2 = -0.4 * GRAVITY_M_S2
"""Vertical acceleration of the pelvis below which nothing carries the body. The limit lies between full gravity, with
which a body in flight falls, and what a body does that legs still support. The causal decision takes the predicted
acceleration, the offline assignment the curvature of the pelvis's height."""

FALL_WINDOW_S = 0.07
"""Duration over which that curvature is fitted; long enough for the noise of a differentiated height. Causal: a fall
that has been predicted for that long has to show in it."""

FALL_EDGE_S = 0.02
"""Offline: flight begins and ends this much earlier and later, as the window blurs its edges."""

BELT_WINDOW_S = 1.0
STILL_FLOOR_S = 0.1
BELT_FROM_M_S = 0.4
"""Causal: the floor's velocity is the median of what low sole points did over the last second, with a tenth of a
second's worth of a floor that stands still, and nothing below the last limit, which standing feet may do anyway."""

TOUCH_HEIGHT_M = 0.025
"""Soles within this height of each other, or of the floor, are level with it. Offline, a lower sole point touches."""

TOUCH_SPEED_M_S = 0.4
"""Offline: a sole point that is low and slower than this touches. Strict, and without delay, because a touching foot
without a plate only invalidates its frame."""

STAND_HEIGHT_M = 0.045
STAND_SPEED_M_S = 0.8
STAND_AFTER_S = 0.025
"""Causal: a foot lower and slower than this for that long carries weight, unless a plate below it reads nothing. The
limits are wider than offline, since a landing heel is pitched and touches above the level of a flat sole, and since a
foot held to be in the air would be denied its reaction. The delay gives the foot's plate time to read first."""

ALONE_HEIGHT_M = 0.06
ALONE_SPEED_M_S = 3.0
"""Causal: the limits for a foot beside which nothing else carries the body: a runner lands on a foot that is still
that fast against the floor. Held to be in the air, it would make the body fall; held to bear too early, it is found to
carry nothing."""

LEAVE_SLACK = 1.7
"""Causal: a standing foot has left the floor when it is higher or faster than the above times this. Hysteresis against
decisions that alternate between frames."""

SOLE_ENDS = 2
"""Causal: points of a sole that give its height, heel and ball. The toe end dips below the floor when the toes bend,
and the learnt floor would follow; the offline floor is a median over the trial and takes all three."""

FLOOR_SHARE = 0.1
"""Causal: share by which the floor's height under a loaded foot is corrected per frame."""

FLOOR_PERCENTILE = 5.0
"""Offline: without a loaded frame, the floor lies at this percentile of the sole's lowest heights."""

KEEP_M = 0.04
"""Causal: a plate stays with its foot until the other sole is nearer by this. Offline, the whole stretch of loading
decides instead."""

MAJORITY_S = 0.05
MIXED_SHARE = 0.2
"""Offline: where more than this share of a stretch of loading is nearer to the other sole, the plate changes feet
within the stretch, and each frame follows the majority of the frames up to so much earlier and later."""

LEVEL_M = 0.09
PARTED_M_S = 1.2
"""Two feet stand on one plate while the lowest points of their soles are level to this (toes that bend dip into the
floor by 40 mm, a landing heel is above it by as much), and move so slowly against each other: on a belt both move, a
foot that swings is faster by 3 m/s. Causal: feet that share a plate must part faster by the slack above."""

STANDING_SHARE = 0.05
"""Offline: share of body weight that the plates must carry for a frame outside flight to be fully measured."""

FLAT_FROM, FLAT_TO = 0.1, 0.6
"""Causal: a foot whose load lies between these shares of its sole, from heel to toe end, lies flat."""

FACES_DOWN = 0.25
"""Cosine of a sole's tilt from level below which nobody stands on it: feet push off at up to 65°, a kneeling foot on
its toes or its instep is tilted by more than 80°."""
