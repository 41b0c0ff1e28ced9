"""Strides that cannot be: each with its reason; the others stay."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.imu.stride_doubts import REACH_M, doubted, out_of_reach
from mbkf.imu.strides import Stride

USUAL = Stride(0, 100, 0.0, 1.0, 1.3, 0.02, 0.0, 0.1, 0.5, 0.0)


def test_usual_strides_stay():
    assert all(stride.doubt == "" for stride in doubted([USUAL] * 5))
    unknown = replace(USUAL, length_sd_m=np.nan, turn_rad=np.nan)
    assert doubted([unknown])[0].doubt == ""


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"length_m": 9.0}, "longer than any person"),
        ({"length_m": 4.0, "end_s": 0.2}, "faster"),
        ({"rise_m": -3.0}, "rise by 3.0 m"),
        ({"length_sd_m": 0.4}, "known to 0.40 m only"),
        ({"swing_s": 1.6}, "a stance was missed"),
    ],
)
def test_others_are_refused_with_their_reason(change, told):
    found = doubted([USUAL] * 4 + [replace(USUAL, **change)])
    assert told in found[-1].doubt
    assert not any(stride.doubt for stride in found[:-1])


def test_feet_stay_within_reach():
    times = np.linspace(0.0, 2.0, 201)
    path = np.column_stack([1.3 * times, 0.0 * times, 0.0 * times])
    near, far = np.add(path, [0.0, 0.2, 0.0]), path * 4.0
    assert out_of_reach([USUAL], times, path, times, near)[0].doubt == ""
    assert f"{3.0 * 1.3:.1f} m apart" in out_of_reach([USUAL], times, path, times, far)[0].doubt
    assert REACH_M < 3.9
    assert out_of_reach([USUAL], times, path, times + 100.0, far)[0].doubt == ""
    assert out_of_reach([USUAL], times, path, times, np.full_like(far, np.nan))[0].doubt == ""
