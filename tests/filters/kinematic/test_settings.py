"""One noise for all markers in place of their own."""

import numpy as np

from mbkf.filters.kinematic.settings import KinematicSettings


def test_one_noise_takes_the_place_of_the_markers_own():
    own = np.array([0.005, 0.01])
    assert KinematicSettings().noise(own) is own
    np.testing.assert_array_equal(KinematicSettings(marker_noise_m=0.004).noise(own), [0.004, 0.004])
