"""A capture played by the simulated DataStream server arrives whole, and the source outlives whatever it may do."""

import socket
import struct
import threading
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.streams.vicon_server import PlateConvention, ViconServer, block
from mbkf.errors import InvalidInput, UnknownName
from mbkf.stream import reconnecting
from mbkf.stream.played import played
from mbkf.stream.vicon import objects
from mbkf.stream.vicon import source as vicon
from mbkf.stream.vicon.client import Packet
from mbkf.stream.vicon.source import ViconSource
from tests.captures import made_capture
from tests.stream.reading import connected, read
from tests.stream.vicon.test_description import known as described
from tests.stream.vicon_reading import HERE, Laboratory
from tests.waiting import until

CAPTURE = made_capture(30)


@pytest.fixture
def laboratory():
    opened = []

    def make(**options):
        opened.append(Laboratory(CAPTURE, **options))
        return opened[-1]

    yield make
    for one in opened:
        one.close()


@pytest.mark.parametrize("pull", [False, True])
def test_markers_plates_and_counts_arrive(laboratory, pull):
    one = laboratory(pull=pull)
    assert one.stream.marker_names == one.played.stream.marker_names and one.stream.trial == "walker"
    assert (one.stream.rate_hz, one.stream.plate_rate_hz) == (100.0, 1000.0)
    for plate, known in zip(one.stream.plates, one.played.stream.plates, strict=True):
        np.testing.assert_allclose(plate.corners_m, known.corners_m, atol=1e-6)
    found = one.frames(*range(3, 12))
    assert [frame.number for frame in found] == list(range(3, 12))
    for frame in found:
        np.testing.assert_allclose(frame.markers_m, one.played.markers_m[frame.number], atol=1e-12)
        np.testing.assert_array_equal(
            frame.plates.index, np.arange(10 * frame.number, 10 * frame.number + 10)
        )
        np.testing.assert_allclose(frame.plates.wrench, one.played.wrench[frame.plates.index], atol=1e-3)


def test_a_world_whose_y_axis_points_up(laboratory):
    one = laboratory(changes={"y_up": True})
    (frame,) = one.frames(5)
    np.testing.assert_allclose(frame.markers_m, one.played.markers_m[5], atol=1e-12)
    np.testing.assert_allclose(frame.plates.wrench, one.played.wrench[frame.plates.index], atol=1e-3)


def test_the_stated_axis_may_be_overruled(laboratory):
    one = laboratory(up="y")
    (frame,) = one.frames(5)
    np.testing.assert_allclose(frame.markers_m[:, 2], one.played.markers_m[5][:, 1], atol=1e-12)
    with pytest.raises(UnknownName, match="aslant"):
        ViconSource(HERE, 1, up="aslant")


def test_points_without_names(laboratory):
    one = laboratory(unlabelled=True)
    assert one.stream.marker_names == ()
    (frame,) = one.frames(5)
    assert frame.markers_m.shape == (0, 3)
    sent = one.played.markers_m[5]
    np.testing.assert_allclose(frame.unlabelled_m, sent[np.isfinite(sent).all(axis=1)], atol=1e-12)


def test_occluded_markers_are_missing(laboratory):
    one = laboratory()
    one.played.markers_m[7, 3] = np.nan
    (frame,) = one.frames(7)
    assert np.isnan(frame.markers_m[3]).all() and np.isfinite(np.delete(frame.markers_m, 3, axis=0)).all()


def test_the_conventions_of_plates_are_reported(laboratory):
    one = laboratory(convention=PlateConvention(True, 1.0, 1e-3))
    found = one.frames(*range(10))
    assert (
        one.event("plates axes") == "Vicon states forces on the body, moments in N m about the plate's origin"
    )
    last = found[-1].plates
    np.testing.assert_allclose(last.wrench, one.played.wrench[last.index], atol=1e-3)


def test_a_subject_is_chosen_by_name(laboratory):
    assert laboratory(person="walker").stream.marker_names == laboratory().stream.marker_names
    source = ViconSource(HERE, laboratory().server.port, person="nobody")
    with pytest.raises(UnknownName, match="unknown subject 'nobody'"):
        connected(source)
    source.close()


def test_markers_renamed_and_back_are_followed_by_name(laboratory):
    one = laboratory()
    known = list(one.server.names)
    one.server.names = [*known[::-1]]
    one.server.played = one.played
    (frame,) = one.frames(5)
    np.testing.assert_allclose(frame.markers_m, one.played.markers_m[5][::-1], atol=1e-12)
    one.server.names = [f"x{name}" for name in known]
    one.ask()
    one.server.send_frame(list(one.played.frames())[6])
    assert "none of the known markers" in one.event("refused")
    one.server.names = known
    (frame,) = one.frames(8)
    np.testing.assert_allclose(frame.markers_m, one.played.markers_m[8], atol=1e-12)


def test_a_connection_that_breaks_off_is_made_anew(laboratory, monkeypatch):
    monkeypatch.setattr(reconnecting, "AGAIN_S", 0.01)
    one = laboratory()
    port = one.server.port
    one.server.close()
    assert "broke off" in one.event("connection")
    one.server = ViconServer(one.played, port=port)
    assert "is back" in one.event("connection")
    (frame,) = one.frames(9)
    assert frame.number == 9


def test_silence_ends_a_connection(laboratory, monkeypatch):
    one = laboratory()
    monkeypatch.setattr(reconnecting, "RECONNECT_AFTER_S", -1.0)
    assert "it is silent" in one.event("connection")


def test_silence_counts_from_the_first_read_on():
    server = ViconServer(played(CAPTURE))
    source = ViconSource(HERE, server.port)
    connected(source)
    source._heard_s = float("-inf")  # the filter was loaded meanwhile
    source.read(0.0)
    assert source.connected
    source.close()
    server.close()


def test_packets_that_cannot_be_read_are_left_out(laboratory):
    one = laboratory()
    for data in (b"", b"\1" * 9, block(5, b""), block(6, struct.pack("<I", 10**6)), block(10, b"\0" * 11)):
        one.server.raw_to_all(block(0x1A2B0001, data))
    one.server.raw_to_all(block(0x1A2B0001, block(5, struct.pack("<I", 3)) + block(6, b"\xff" * 40)))
    assert "left out" in one.event("packets")
    assert [frame.number for frame in one.frames(4, 5)] == [4, 5]


def test_bytes_that_are_no_packet_end_the_connection(laboratory, monkeypatch):
    monkeypatch.setattr(reconnecting, "AGAIN_S", 0.01)
    one = laboratory()
    one.server.raw_to_all(b"\xff" * 64)
    news = []

    def told():
        one.source.read(0.01)
        news.extend(sentence for kind, sentence in one.source.news() if kind == "connection")
        return len(news) == 2

    until(told)
    assert "broke off" in news[0] and "is back" in news[1]
    assert [frame.number for frame in one.frames(4)] == [4]


def test_plates_that_begin_to_send_with_the_second_frame_are_described(monkeypatch):
    forces = [struct.pack("<4I", 1, 7, 1, 0), struct.pack("<4I30f", 2, 7, 1, 30, *range(30))]
    waiting = [
        Packet(0.0, described(FRAME_INFO=[struct.pack("<I", k)], FORCE=[one])) for k, one in enumerate(forces)
    ]
    source = ViconSource(HERE, 801)
    monkeypatch.setattr(source, "_take", lambda _: waiting.pop(0))
    (plate,) = connected(source).plates
    assert plate.rate_hz == 1000.0


def test_markers_stand_where_their_ids_say_and_stay_while_they_are_unchanged(monkeypatch):
    def labelled(*markers):
        rows = [struct.pack("<2Id3d9dI", *ids, 7.0, *place, *np.eye(3).ravel(), 0) for ids, place in markers]
        return struct.pack("<I", len(rows)) + b"".join(rows)

    point = struct.pack("<Id3d9dI", 1, 7.0, 1000.0, 2000.0, 3000.0, *np.eye(3).ravel(), 0)
    markers = labelled(((2, 0), (9.0, 9.0, 9.0)), ((1, 1), (4.0, 5.0, 6.0)), ((1, 0), (1.0, 2.0, 3.0)))
    unchanged = struct.pack("<4I", 0, 2, objects.LABELED, objects.UNLABELED)
    shown = [{}, {}, {"LABELED": [markers], "UNLABELED": [point]}, {"CONTENTS": [unchanged]}, {}]
    waiting = [
        Packet(0.0, described(FRAME_INFO=[struct.pack("<I", k)], **one)) for k, one in enumerate(shown)
    ]
    source = ViconSource(HERE, 801)
    monkeypatch.setattr(source, "_take", lambda _: waiting.pop(0))
    assert connected(source).marker_names == ("LASI", "RASI")
    first, second, third = (source.read(1.0) for _ in range(3))
    for frame in (first, second):
        np.testing.assert_allclose(frame.markers_m, 1e-3 * np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
        np.testing.assert_allclose(frame.unlabelled_m, [[1.0, 2.0, 3.0]])
    assert np.isnan(third.markers_m).all() and not len(third.unlabelled_m)


def test_packets_without_end_that_describe_nothing_end_no_later_than_asked(monkeypatch):
    waiting = [Packet(0.0, {})] * 5
    source = ViconSource(HERE, 801)
    monkeypatch.setattr(source, "_take", lambda _: waiting.pop())
    assert source.connect(0.0) is None and len(waiting) == 4


def test_an_attempt_that_outlasts_the_time_is_the_last_one(monkeypatch):
    clock, attempts = [0.0], []

    def slow(timeout_s):
        attempts.append(timeout_s)
        clock[0] += 2.0

    source = ViconSource(HERE, 801)
    monkeypatch.setattr(source, "_take", slow)
    monkeypatch.setattr(vicon, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    assert source.connect(1.5) is None and attempts == [1.5]


def test_another_server_is_refused():
    with socket.create_server((HERE, 0)) as server:

        def answer():
            connection, _ = server.accept()
            with connection:
                connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                connection.recv(1)

        thread = threading.Thread(target=answer)
        thread.start()
        source = ViconSource(HERE, server.getsockname()[1])
        with pytest.raises(InvalidInput, match="not a DataStream server"):
            until(lambda: source.connect(0.2))
        source.close()
        thread.join()


def test_a_server_that_is_not_there_is_waited_for(monkeypatch):
    with socket.create_server((HERE, 0)) as server:
        port = server.getsockname()[1]
    monkeypatch.setattr(reconnecting, "AGAIN_S", 0.01)
    source = ViconSource(HERE, port)
    assert source.connect(0.0) is None and source.connect(0.0) is None
    server = ViconServer(played(CAPTURE), port=port)
    assert connected(source).rate_hz == 100.0
    assert source.read(0.0) is None
    until(server.listening)
    server.send(next(iter(played(CAPTURE).frames())), 0.0)
    assert read(source, 1)[0].number == 0
    source.close()
    server.close()
