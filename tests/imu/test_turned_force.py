"""Gravity stays where it is when the gyroscope is right."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.imu.turned_force import mean_force
from tests.imu.turning import RATE_HZ, turning

MADE = turning(3.0, rate_rad_s=4.0)


@pytest.mark.parametrize(("scale", "least", "most"), [(1.0, 0.98, 1.02), (0.5, 0.0, 0.9)])
def test_the_mean_force_shows_a_gyroscope_that_reads_too_little(scale, least, most):
    turns = scale * MADE.gyro[None] / RATE_HZ
    assert least <= mean_force(turns, np.asarray(MADE.force)[None]) / GRAVITY_M_S2 <= most
