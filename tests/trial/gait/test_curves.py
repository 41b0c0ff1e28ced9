"""Curves of a side: its own coordinates and the midline's, torques and powers of joints alone."""

import numpy as np

from mbkf.trial.gait.curves import side_curves
from tests.recordings import walk


def test_curves_of_a_side():
    r = walk()
    found = {(one.quantity, one.name): one for one in side_curves(r, 1)}
    assert ("angle", "knee_angle") in found and ("angle", "pelvis_tilt") in found
    assert not any(name.endswith(("_r", "_l")) for _, name in found)
    knee = found[("torque", "knee_angle")]
    np.testing.assert_array_equal(knee.value, r.moment("knee_angle_l"))
    np.testing.assert_array_equal(knee.offset_sd, r.moment_sd("knee_angle_l", "offset"))
    power = found[("power", "knee_angle")]
    np.testing.assert_array_equal(power.value, r.power("knee_angle_l"))
    assert ("torque", "pelvis_tilt") not in found and found[("angle", "pelvis_tx")].unit == "m"
