"""A stream of MVN described by its first samples: rate, steps, unit, axes, segments."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.stream.xsens.description import describe
from mbkf.stream.xsens.joining import MvnSample
from mbkf.stream.xsens.packets import POSES, TRACKERS


def samples(rate_hz=60.0, step=1, count=61, head=(0.0, 0.0, 0.6), ids=(1, 7), clock=True):
    found = []
    for k in range(count):
        values = np.zeros((len(ids), 7))
        values[ids.index(7) if 7 in ids else 0, :3] = head
        values[:, 3] = 1.0
        time_ms = round(1e3 * k / rate_hz) if clock else 77
        found.append(MvnSample(900 + step * k, time_ms, 5.0 + k / rate_hz, np.array(ids), values))
    return found


@pytest.mark.parametrize("rate_hz", [24.0, 60.0, 120.0, 240.0])
def test_the_rate_by_mvns_clock_of_whole_milliseconds(rate_hz):
    found = describe(samples(rate_hz, count=int(rate_hz) + 1), POSES, None)
    assert found.stream.rate_hz == rate_hz and found.step == 1
    assert found.stream.sensors == ("pelvis", "head") and found.ids == (1, 7) and not found.remarks


def test_a_sender_that_skips_samples_counts_in_steps():
    found = describe(samples(60.0, step=4), POSES, None)
    assert (found.step, found.stream.rate_hz) == (4, 60.0)


def test_a_clock_that_stands_still_leaves_the_times_of_arrival():
    assert describe(samples(clock=False), POSES, None).stream.rate_hz == 60.0


def test_samples_of_one_moment_have_no_rate():
    with pytest.raises(InvalidInput, match="no possible frame rate"):
        describe(samples(rate_hz=1e9, clock=False), POSES, None)
    there, back = samples(count=2, rate_hz=1e9)[0], samples(count=2, rate_hz=20.0)[1]
    with pytest.raises(InvalidInput, match="no possible frame rate"):
        describe([there, back, replace(there, number=902)], POSES, None)


def test_centimetres_are_seen_by_the_trunk():
    found = describe(samples(head=(5.0, 0.0, 60.0)), POSES, None)
    assert found.metres == 0.01 and [kind for kind, _ in found.remarks] == ["unit"]


def test_a_y_axis_that_points_up_is_seen_by_the_trunk():
    found = describe(samples(head=(0.0, 0.6, 0.05)), POSES, None)
    np.testing.assert_allclose(found.rotation @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)
    assert [kind for kind, _ in found.remarks] == ["axes"]
    stated = describe(samples(head=(0.0, 0.6, 0.05)), POSES, "z")
    np.testing.assert_array_equal(stated.rotation, np.eye(3))
    assert not stated.remarks
    with pytest.raises(UnknownName, match="upwards"):
        describe(samples(), POSES, "upwards")


def test_arms_are_turned_from_the_t_pose_to_hanging():
    found = describe(samples(ids=(1, 9, 13)), TRACKERS, None)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(found.laid, [[0, 0, 0, 1], [-half, 0, 0, half], [half, 0, 0, half]])


def test_props_alone_are_no_person():
    with pytest.raises(InvalidInput, match="no segment of a person"):
        describe(samples(ids=(25, 26)), POSES, None)
