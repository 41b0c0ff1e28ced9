"""A result without markers and plates: the filter's own numbers, at the frames' times."""

import numpy as np
import pytest

from mbkf.filters.estimate import Recording
from mbkf.filters.tracking import track
from mbkf.model.human import HumanModel
from mbkf.sensors.standing_feet import FOOT_REST
from mbkf.trial.inertial.motion_inputs import motion_inputs
from mbkf.trial.inertial.motion_result import Timeline, motion_result
from mbkf.trial.inertial.on_body import frame_readings
from mbkf.trial.live.worn import live_worn
from tests.worn import RATE_HZ, worn


@pytest.fixture(scope="module")
def tracked():
    turn = worn("turn", 14.0)
    imus = frame_readings(turn.moving, turn.moving[0].time_s)
    found = live_worn(turn.model, [one.name for one in turn.moving], imus[:200], RATE_HZ)
    none = np.zeros((40, 0, 3)), np.zeros((40, 0, 6))
    recording = Recording(*none, 1.0 / RATE_HZ, imus[200:240], {FOOT_REST: np.ones((40, 2))})
    return turn, found.segments, track(found.filter, recording, body=found.body)


def test_it_is_what_the_filter_found(tracked):
    turn, segments, found = tracked
    timeline = Timeline("turn", RATE_HZ, 2.0)
    result = motion_result(
        turn.subject, segments, timeline, found, notes=["a remark"], more={"inertial": {"x": 1}}
    )
    np.testing.assert_array_equal(result.q, found.q)
    np.testing.assert_allclose(result.times_s, 2.0 + np.arange(40) / RATE_HZ, atol=1e-12)
    assert result.protocol == "inertial sensors" and result.trial == "turn"
    assert result.settings["inertial"] == {"x": 1} and "a remark" in result.warnings
    assert result.marker_names == () and not result.smoothed
    # The feet bear the body, and what Newton's law leaves is small beside it.
    weight = 9.80665 * turn.model.mass_kg
    assert result.foot_wrench[20:, :, 2].sum(axis=1).mean() == pytest.approx(weight, rel=0.05)


def test_dofs_that_move_no_sensor_are_told(tracked):
    turn, segments, found = tracked
    result = motion_result(turn.subject, segments, Timeline("turn", RATE_HZ, 0.0), found)
    untold = motion_inputs(HumanModel.of(turn.subject), 0.01, segments).unobservable
    told = next(one for one in result.warnings if "move no sensor" in one)
    assert told.startswith(f"{untold.sum()} dofs") and untold.sum() > 20
