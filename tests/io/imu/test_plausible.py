"""Readings that no sensor gives are refused with their sensor and sample; all others stay as they are."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.imu.plausible import MOST_MPS2, MOST_RAD_S, MOST_UT, plausible_readings
from mbkf.io.imu.readings import ImuReadings

TIMES = np.arange(5) / 100.0


def sensor(**changed):
    zeros = np.zeros((5, 3))
    return replace(ImuReadings("foot", TIMES, zeros, zeros, zeros, 100.0, "", np.eye(4)[[3] * 5]), **changed)


def with_one(value, width=3):
    found = np.zeros((5, width))
    found[3, 1] = value
    return found


def test_what_is_possible_or_missing_stays():
    for one in (
        sensor(),
        sensor(specific_force_mps2=with_one(-MOST_MPS2), angular_velocity_rad_s=with_one(np.nan)),
        sensor(magnetic_field=None, orientation=None, time_s=np.array([0.0, 0.0, 0.1, 0.1, 9.0])),
    ):
        assert plausible_readings([one], "a.csv") == (one,)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"specific_force_mps2": with_one(-1.1 * MOST_MPS2)}, r"acceleration of 1\.1e\+04 m/s² in sample 4"),
        ({"angular_velocity_rad_s": with_one(np.inf)}, "angular velocity of inf rad/s in sample 4"),
        ({"angular_velocity_rad_s": with_one(1.1 * MOST_RAD_S)}, "angular velocity"),
        ({"magnetic_field": with_one(2.0 * MOST_UT)}, "magnetic field"),
        ({"orientation": with_one(3.0, 4)}, "quaternion of 3 in sample 4"),
        ({"rate_hz": 1e9}, r"rate is 1e\+09 Hz"),
        ({"time_s": TIMES[::-1]}, "time of sample 2"),
        ({"time_s": np.where(TIMES[3] == TIMES, np.nan, TIMES)}, "time of sample 4"),
    ],
)
def test_what_cannot_be_is_refused(changed, reason):
    with pytest.raises(InvalidInput, match=rf"a\.csv: sensor foot.*{reason}"):
        plausible_readings([sensor(), sensor(**changed)], "a.csv")
