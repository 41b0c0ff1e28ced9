"""A frame in one call of the kernel is, bit by bit, the frame that blocks decide."""

import numpy as np
import pytest

from mbkf.filters.filter import Filter
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.kernel.loading import library
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.followed import inputs, recording
from tests.motions import markers_only

FRAMES = range(40, 50)


def made(sensor=None, **changes):
    known = inputs()
    sensor, hidden = sensor or known.sensor, np.zeros(known.sensor.model.nv, dtype=bool)
    noise_m = known.noise_m[: len(sensor.segments)]
    return KinematicFilter(sensor, noise_m, known.dt_s, hidden, KinematicSettings(**changes))


def disturbed(kalman, how):
    """Markers of some frames, the sixth of which is disturbed."""
    markers = recording().markers_m[: len(FRAMES)].copy()
    segments = np.array(kalman.sensor.segments)
    if how.startswith("one missing"):
        markers[6, 3] = np.nan
    if how == "one far":
        markers[6, 3] += 0.4
    if how == "a limb missing":
        markers[6, segments == segments[-1]] = np.nan
    if how == "few":
        markers[6, 5:] = np.nan
    return markers


@pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")
@pytest.mark.parametrize(
    ("how", "decided"),
    [
        ("nothing", 0),
        ("one missing", 0),
        ("one missing of those asked for", 1),
        ("one far", 1),
        ("a limb missing", 1),
        ("few", 1),
    ],
)
def test_it_is_the_step_of_blocks(how, decided, monkeypatch):
    kalman = made(min_markers=36 if how == "one missing of those asked for" else 6)
    markers, corrected, own = disturbed(kalman, how), [], Filter.correct
    state, memory = kalman.start(markers[0]), kalman.begin()
    monkeypatch.setattr(Filter, "correct", lambda *given: corrected.append(1) or own(*given))
    for measured in markers[1:]:
        expected = Filter.step(kalman, state, memory, markers_only(measured))
        before = len(corrected)
        found = kalman.step(state, memory, markers_only(measured))
        decided -= len(corrected) - before
        for one, other in ((found.state, expected.state), (found.prior.state, expected.prior.state)):
            for name in ("q", "v", "P"):
                np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
        for name in ("matrix", "vector", "rows", "values"):
            np.testing.assert_array_equal(getattr(found.readings, name), getattr(expected.readings, name))
        for one, other in zip(found.readings.instruments, expected.readings.instruments, strict=True):
            np.testing.assert_array_equal(one, other)
        notes, others = found.decisions.notes, expected.decisions.notes
        for name in ("seen", "trusted", "unobserved", "observed", "lost", "squared_m2"):
            np.testing.assert_array_equal(getattr(notes, name), getattr(others, name), err_msg=name)
        for one, other in zip(found.innovations, expected.innovations, strict=True):
            np.testing.assert_array_equal(one, other)
        again = kalman.linearise(found.state, found.decisions)
        np.testing.assert_array_equal(again.matrix, kalman.linearise(found.state, expected.decisions).matrix)
        state, memory = found.state, found.memory
    assert decided == 0


def test_blocks_decide_where_joint_limits_bear_on_the_pose_beside_a_segment_without_markers():
    known = inputs()
    whole = known.sensor
    kept = [k for k, segment in enumerate(whole.segments) if segment != "right_thigh"]
    assert 0 < len(kept) < len(whole.segments)
    sensor = MarkerSensor(whole.model, [whole.segments[k] for k in kept], whole.local_m[kept])
    kalman = made(sensor)
    assert isinstance(kalman.blocks[-1], JointLimits)
    assert kalman._one_call is None
