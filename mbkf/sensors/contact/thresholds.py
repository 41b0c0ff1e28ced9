"""Limits by which contact of feet with plates and floor is decided."""

REACH_M = 0.20
"""A centre of pressure further than this from a sole belongs to no foot."""

TOUCH_HEIGHT_M = 0.025
TOUCH_SPEED_M_S = 0.4
"""A sole point lower and slower than this touches the floor."""

STANDING_SHARE = 0.05
"""Share of body weight that the plates must carry when someone stands on the floor."""

FALL_SHARE = 0.4
FALL_WINDOW_S = 0.07
FALL_EDGE_S = 0.02
"""Flight: the pelvis falls with this share of gravity, judged over a short window, give or take an edge."""

KEEP_M = 0.04
"""A plate stays with its foot until the other one is nearer by this."""

BETWEEN_M = 0.02
"""A centre of pressure nearer to a sole than this is that foot's, and not between two."""

LEAVE_SLACK = 1.7
"""A standing foot has left the floor when it is higher or faster than the above times this."""

SOLE_ENDS = 2
"""Points of a sole that tell its height: heel and ball; its toe end dips below the floor when the toes bend."""

STAND_HEIGHT_M = 0.045
STAND_SPEED_M_S = 0.8
STAND_AFTER_S = 0.025
"""A foot lower and slower than this for that long carries, unless a plate below it says no. Landing heels are pitched,
so that they touch a little above a flat sole; the delay lets a plate speak first."""

FLAT_FROM, FLAT_TO = 0.1, 0.6
"""A foot whose load lies between these shares of its sole, from heel to toe end, lies flat."""

FLOOR_SHARE = 0.1
"""How fast the height of the floor under a loaded foot is learnt, per frame."""
