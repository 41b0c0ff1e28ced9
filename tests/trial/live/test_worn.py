"""Inertial sensors on a stream: calibrated by standing still, and then followed as in a recording."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.imu.rest_watch import FeetAtRest
from mbkf.model.clinical import ClinicalAngles
from mbkf.sensors.block import Frame
from mbkf.sensors.standing_feet import FOOT_REST
from mbkf.trial.inertial.on_body import frame_readings
from mbkf.trial.live.filter import LiveFilter
from mbkf.trial.live.worn import StandingSensors, live_worn
from tests.worn import RATE_HZ, worn

FLEXION = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl"]
NAMES = ("pelvis", "left_foot")


@pytest.fixture(scope="module")
def turn():
    """A person who stands for 2.3 s, and then turns round in steps for 3 s."""
    return worn("turn", 9.0)


@pytest.fixture(scope="module")
def imus(turn):
    return frame_readings(turn.moving, turn.moving[0].time_s)


@pytest.fixture(scope="module")
def calibrated(turn, imus):
    names = [one.name for one in turn.moving]
    return live_worn(turn.model, names, imus[:200], RATE_HZ, turn.motion.q[100])


def frames(calibrated, model, imus):
    feet = FeetAtRest(model.roles.feet, calibrated.segments, RATE_HZ, calibrated.settings.filter.stillness)
    ordered = imus[:, list(calibrated.columns)]
    return ordered, np.array([feet.push(one) for one in ordered])


def test_frame_by_frame_it_is_the_filter_on_the_whole_recording(turn, imus, calibrated):
    """From standing into the turn."""
    ordered, rest = frames(calibrated, turn.model, imus[200:300])
    none = np.zeros((100, 0, 3)), np.zeros((100, 0, 6))
    recording = Recording(*none, 1.0 / RATE_HZ, ordered, {FOOT_REST: rest})
    expected = [estimate for _, estimate, _ in followed(TrackingLoop(calibrated.filter), recording)]
    live = LiveFilter(calibrated.filter)
    steps = [
        step
        for t in range(100)
        for step in live.push(t, Frame(none[0][t], none[1][t], ordered[t], {FOOT_REST: rest[t]}))
    ]
    assert len(steps) == len(expected) == 100
    for step, other in zip(steps, expected, strict=True):
        for field in ("q", "v", "a", "wrench"):
            np.testing.assert_array_equal(getattr(step.estimate, field), getattr(other, field))


def test_it_follows_a_person_who_stood_still(turn, imus, calibrated):
    ordered, rest = frames(calibrated, turn.model, imus[200:])
    live, clinical = LiveFilter(calibrated.filter), ClinicalAngles(turn.model)
    none = np.zeros((0, 3)), np.zeros((0, 6))
    steps = [
        step
        for t, one in enumerate(ordered)
        for step in live.push(t, Frame(*none, one, {FOOT_REST: rest[t]}))
    ]
    chosen = [clinical.names.index(name) for name in FLEXION]
    own = clinical.angles(np.array([step.estimate.q for step in steps]))
    apart = np.degrees(own - clinical.angles(turn.motion.q[200:]))[:, chosen]
    assert np.sqrt((apart**2).mean(axis=0)).max() < 4.0


def test_lost_frames_do_not_end_it(turn, imus, calibrated):
    live, none = LiveFilter(calibrated.filter), (np.zeros((0, 3)), np.zeros((0, 6)))
    ordered, rest = frames(calibrated, turn.model, imus[200:280])
    steps = []
    for t, one in enumerate(ordered):
        lost = 40 <= t < 60
        steps += live.push(t, Frame(*none, None if lost else one, {FOOT_REST: rest[t] * (not lost)}))
    assert len(steps) == 80 and all(step.estimate is not None for step in steps)
    assert sum(step.estimate.started for step in steps) == 1


def test_names_are_segments_and_none_has_two_sensors(turn, imus):
    with pytest.raises(InvalidInput, match="two sensors sit on pelvis"):
        live_worn(turn.model, ["pelvis", "hips"], imus[:200, :2], RATE_HZ)
    with pytest.raises(UnknownName, match="gadget"):
        live_worn(turn.model, ["pelvis", "gadget"], imus[:200, :2], RATE_HZ)


def still(turning=0.0):
    found = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 9.81], (2, 1))
    found[1, 1] = turning
    return found


def test_two_seconds_without_turning_are_standing():
    watch = StandingSensors(NAMES, 25.0)
    for k in range(50):
        assert not watch.enough and watch.progress == pytest.approx(k / 50)
        watch.push(still(0.05))
    assert watch.enough and watch.readings().shape == (50, 2, 6)


def test_what_keeps_standing_from_being_over_is_told():
    watch = StandingSensors(NAMES, 25.0)
    for _ in range(60):
        watch.push(still(1.0))
    assert not watch.enough and watch.progress == 0.0
    assert watch.hindrance == "sensor left_foot turns at 57 deg/s"
    gone = still()
    gone[0, 3] = np.nan
    watch.push(gone)
    assert watch.hindrance == "sensor pelvis reads nothing"
    for _ in range(49):
        watch.push(still())
    assert not watch.enough and "less than 2 s" in watch.hindrance
    watch.push(still())
    assert watch.enough


def test_the_order_of_sensors_does_not_matter(turn, imus, calibrated):
    names = [one.name for one in turn.moving]
    order = [3, 1, 0, 2, 7, 6, 5, 4]
    other = live_worn(turn.model, [names[k] for k in order], imus[:200, order], RATE_HZ, turn.motion.q[100])
    mounts = {mount.segment: mount for mount in other.worn.mounts}
    for mount in calibrated.worn.mounts:
        np.testing.assert_allclose(mounts[mount.segment].rotation, mount.rotation, atol=1e-12)
    assert other.worn.mounts[0].segment == "pelvis"
