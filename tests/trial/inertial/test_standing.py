"""When a person stands still, and which sensor comes first."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import ImuReadings
from mbkf.trial.inertial.standing import root_first, standing_window

TIMES = np.arange(500) / 100.0


def sensor(moving_until_s, again_from_s=np.inf):
    moves = (moving_until_s > TIMES) | (again_from_s <= TIMES)
    rates = np.where(moves[:, None], 1.0, 0.01) * np.ones(3)
    return ImuReadings("one", TIMES, np.ones((500, 3)), rates, None, 100.0)


def test_the_first_second_in_which_no_sensor_turns_and_those_after_it():
    window = standing_window([sensor(0.5), sensor(2.0)], TIMES)
    assert TIMES[window.start] == pytest.approx(2.0, abs=0.05) and window.stop - window.start == 250


@pytest.mark.parametrize(("until_s", "lasts_s"), [(1.0, 1.0), (1.6, 1.1), (2.2, 1.7), (4.0, 2.5)])
def test_a_standing_ends_half_a_second_before_a_movement(until_s, lasts_s):
    window = standing_window([sensor(0.0, until_s)], TIMES)
    assert window.start == 0 and window.stop / 100.0 == pytest.approx(lasts_s, abs=0.03)


def test_stated_times_count_and_have_to_be_there():
    assert standing_window([sensor(9.0)], TIMES, (1.0, 2.0)) == slice(100, 201)
    with pytest.raises(InvalidInput, match="correct --standing"):
        standing_window([sensor(0.0)], TIMES, (7.0, 8.0))
    with pytest.raises(InvalidInput, match="never stands still"):
        standing_window([sensor(9.0)], TIMES)


def test_the_root_comes_first_and_no_segment_twice():
    assert root_first(["torso", "pelvis", "right_foot"], "pelvis")[0] == 1
    with pytest.raises(InvalidInput, match="two sensors"):
        root_first(["pelvis", "torso", "torso"], "pelvis")
