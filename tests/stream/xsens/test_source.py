"""A suit's motion through the simulated streamer into the source: readings, persons, types, counts, odd datagrams."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.streams.xsens_server import XsensServer, suit_of
from mbkf.errors import InvalidInput
from mbkf.stream.xsens.readings import HELD_S
from mbkf.stream.xsens.source import VAIN_S, XsensSource
from tests.stream.xsens_datagrams import datagram, pose, upright
from tests.worn import worn

UP = np.array([0.0, 0.0, 9.80665])
HERE, RATE_HZ, FIRST, MOST_SENT = "127.0.0.1", 100.0, 102, 60


@pytest.fixture(scope="module")
def suit():
    made = worn("turn", 9.0)
    return suit_of(made.model, made.motion.q[230:350], RATE_HZ)


class Sending:
    """A simulated streamer and the source that has heard a second of it."""

    def __init__(self, suit, kinds=(2,), number=0, **options):
        self.source = XsensSource(0, HERE, **options)
        self.server, self.kinds = XsensServer(suit, self.source.port), kinds
        self.stream = None
        for k in range(FIRST):
            self.server.play(k, kinds, number + k)
            for _ in kinds:
                self.stream = self.stream or self.source.connect(0.0)
        assert self.source.read(0.0) is None and self.source.receiving

    def frames(self, *numbers, kinds=None):
        """Plays frames and returns those that arrive."""
        for number in numbers:
            self.server.play(number, kinds or self.kinds)
        return self.rest()

    def rest(self):
        found = [self.source.read(0.0) for _ in range(MOST_SENT)]
        return [one for one in found if one is not None]

    def close(self):
        self.server.close()
        self.source.close()


@pytest.fixture
def sending(suit):
    opened = []

    def make(*args, **options):
        opened.append(Sending(suit, *args, **options))
        return opened[-1]

    yield make
    for one in opened:
        one.close()


def expected(suit, frame, segment):
    """Angular velocity and specific force of a segment by the suit itself, and its orientation."""
    here = [Rotation.from_quat(suit.turns[frame + k, segment][[1, 2, 3, 0]]) for k in (-1, 0, 1)]
    turning = RATE_HZ * (here[0].inv() * here[2]).as_rotvec() / 2.0
    places = suit.places_m[frame - 1 : frame + 2, segment]
    free = RATE_HZ**2 * (places[2] - 2.0 * places[1] + places[0])
    return turning, here[1].inv().apply(free + UP), here[1]


def test_segments_come_with_readings_and_orientations(sending, suit):
    one = sending()
    assert one.stream.rate_hz == RATE_HZ and len(one.stream.sensors) == 15
    found = one.frames(*range(40, 60))
    assert [frame.number for frame in found] == list(range(40, 59))
    for name, segment in (("pelvis", 0), ("right_thigh", 15), ("left_foot", 21)):
        turning, felt, turn = expected(suit, 50, segment)
        k = one.stream.sensors.index(name)
        np.testing.assert_allclose(found[10].imus[k, :3], turning, atol=2e-3)
        np.testing.assert_allclose(found[10].imus[k, 3:], felt, atol=2e-2)
        off = Rotation.from_quat(found[10].orientations[k]).inv() * turn
        assert off.magnitude() < 1e-6
    arm = Rotation.from_quat(found[10].orientations[one.stream.sensors.index("right_upper_arm")])
    hanging = Rotation.from_quat(suit.turns[50, 8][[1, 2, 3, 0]]) * Rotation.from_euler("x", -np.pi / 2)
    assert (arm.inv() * hanging).magnitude() < 1e-6


def test_samples_in_several_datagrams_are_the_same(sending):
    whole, parts = sending(), sending()
    for number in (50, 51, 52):
        for data in parts.server.sample(number, 2, number, most=200):
            parts.server.send(data)
    for one, other in zip(whole.frames(50, 51, 52), parts.rest(), strict=True):
        np.testing.assert_array_equal(one.imus, other.imus)
        np.testing.assert_array_equal(one.orientations, other.orientations)


def test_trackers_alone_are_sensors_without_a_known_segment_frame(sending, suit):
    one = sending((23,))
    assert len(one.stream.sensors) == 13 and "right_hand" not in one.stream.sensors
    frame = one.frames(50, 51, 52)[1]
    turn = Rotation.from_quat(suit.turns[51, 15][[1, 2, 3, 0]])
    k = one.stream.sensors.index("right_thigh")
    felt = turn.inv().apply(suit.free_mps2[51, 15] + UP)
    np.testing.assert_allclose(frame.imus[k, 3:], felt, atol=1e-4)
    assert frame.orientations is None


def test_segments_go_before_trackers_and_other_types_are_left_alone(sending):
    one = sending((20, 23, 24, 25, 12, 2))
    assert len(one.stream.sensors) == 15
    assert [frame.number for frame in one.frames(50, 51, 52)] == [50, 51]
    assert not one.source.news()


def test_another_person_is_left_out(sending, suit):
    one = sending()
    other = XsensServer(suit, one.source.port, character=1)
    other._socket.close()
    other._socket = one.server._socket
    other.play(80)
    assert [frame.number for frame in one.frames(50, 51)] == [50]
    assert ("character", "person 1 of MVN is left out; person 0 is followed") in one.source.news()


def test_a_chosen_person_is_waited_for(suit):
    source = XsensSource(0, HERE, character=3)
    server = XsensServer(suit, source.port)
    server.send(upright(0))
    assert source.connect(0.0) is None
    server.send(upright(1, time_ms=round(1e3 * VAIN_S) + 10))
    with pytest.raises(InvalidInput, match="no orientations of this person"):
        source.connect(0.0)
    source.close()
    server.close()


def test_types_that_hold_no_orientations_are_named(suit):
    source = XsensSource(0, HERE)
    server = XsensServer(suit, source.port)
    server.send(datagram(0, kind=1, items=[b"0" * 28]))
    assert source.connect(0.0) is None
    server.send(datagram(1, kind=20, time_ms=round(1e3 * VAIN_S) + 10, items=[b"0" * 20]))
    with pytest.raises(InvalidInput, match=r"types 01, 20 and no orientations"):
        source.connect(0.0)
    source.close()
    server.close()


def test_a_count_that_begins_anew_goes_on(sending):
    one = sending(number=5000)
    one.server.play(60, number=6000)
    one.server.play(61, number=6001)
    found = one.frames(0, 1, 2)
    assert [frame.number for frame in found] == [6000, 6001, 0, 1]


def test_a_lost_frame_leaves_its_neighbours_without_differences(sending):
    found = sending().frames(50, 51, 52, 54, 55, 56)
    assert [frame.number for frame in found] == [50, 51, 52, 54, 55]
    assert [bool(np.isfinite(frame.imus).all()) for frame in found] == [False, True, False, False, True]


def test_a_segment_that_is_gone_is_missing_and_nonsense_is_no_rotation(sending):
    one = sending()
    one.server.send(datagram(50, items=[pose(1, turn=(0.0, 0.0, 0.0, 0.0)), pose(7)]))
    one.server.send(datagram(51, items=[pose(1, turn=(np.nan, 1.0, 1e30, 0.0)), pose(7)]))
    (found,) = one.rest()
    there = np.isfinite(found.orientations).all(axis=1)
    assert [name for name, seen in zip(one.stream.sensors, there, strict=True) if seen] == ["head"]


def test_strange_datagrams_are_left_out_and_frames_go_on(sending):
    one = sending()
    for data in (b"", b"MXTP", upright(3)[:40], datagram(4, items=[b"0" * 5]), b"\xff" * 900):
        one.server.send(data)
    assert [frame.number for frame in one.frames(50, 51, 52)] == [50, 51]
    (kind, sentence), *_ = one.source.news()
    assert kind == "packets" and "left out" in sentence


def test_parts_that_never_come_are_reported(sending):
    one = sending()
    for number in range(50, 60):
        one.server.send(upright(number, counter=0x00))
    assert not one.rest()
    assert ("parts", "samples of which a part never came are left out") in one.source.news()


def test_the_last_frame_comes_when_nothing_follows(sending, monkeypatch):
    one = sending()
    monkeypatch.setattr("mbkf.stream.xsens.readings.HELD_S", -1.0)
    assert [frame.number for frame in one.frames(50)] == [50]
    assert HELD_S > 0.0


def test_a_count_that_stands_still_still_gives_frames(sending, monkeypatch):
    one = sending()
    monkeypatch.setattr("mbkf.stream.xsens.readings.HELD_S", -1.0)
    for _ in range(3):
        one.server.play(50)
    assert one.source.read(0.0).number == 50
