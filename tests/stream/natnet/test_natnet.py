"""A replay through NatNet loses nothing but digits, whatever else is sent, and the source outlives its server."""

import struct
import threading
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.stream.natnet import packets
from mbkf.stream.natnet import source as source_module
from mbkf.stream.natnet.player import NatNetPlayer, axes_of, plates_in_frames
from mbkf.stream.natnet.source import NatNetSource
from mbkf.stream.played import played
from mbkf.stream.replay import ReplaySettings, replay
from tests.captures import made_capture
from tests.stream.natnet import layouts
from tests.stream.natnet.serving import Server, described, frame, nonsense
from tests.stream.reading import connected, read
from tests.stream.scripted import frames_of
from tests.waiting import PATIENCE_S, until

CAPTURE = made_capture(30)


def test_channels_follow_the_c3d_convention():
    """A standing person reads −Fz on plates whose z points down."""
    made = played(CAPTURE)
    channels = plates_in_frames(made)
    assert channels.shape == (30, 2, 10, 6)
    np.testing.assert_allclose(
        channels[..., 2], -made.wrench[:300, :, 2].reshape(30, 10, 2).transpose(0, 2, 1)
    )
    axes = axes_of(CAPTURE.plates[0].corners_m)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3))
    np.testing.assert_array_equal(axes[:, 2], [0.0, 0.0, -1.0])


def test_plates_out_of_step_are_interpolated():
    line = np.arange(300.0)[:, None] * np.ones(3)
    plates = tuple(
        replace(p, force_n=line, moment_nm=line, start_time_s=-0.0005, rate_hz=950.0, corners_m=None)
        for p in CAPTURE.plates
    )
    channels = plates_in_frames(played(replace(CAPTURE, plates=plates)))
    assert channels.shape[2] == 10
    np.testing.assert_allclose(channels[:20, 0, 0, 0], (0.0005 + np.arange(20) / 100.0) * 950.0)


@pytest.fixture
def served():
    """Plays the capture in a thread; yields what starts one, with source and player."""
    open_things = []

    def start(capture=CAPTURE, unlabelled=False, port=0, speed=2.0):
        made = played(capture, unlabelled)
        player = NatNetPlayer(made, "127.0.0.1", port)
        stop = threading.Event()
        thread = threading.Thread(target=replay, args=(made, player, ReplaySettings(speed), stop))
        thread.start()
        open_things.append((player, stop, thread))
        return player

    yield start
    for player, stop, thread in open_things:
        stop.set()
        thread.join()
        player.close()


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """A computer that is busy for some seconds is no silence of the server."""
    monkeypatch.setattr(source_module, "RECONNECT_AFTER_S", PATIENCE_S)


def single(values):
    return np.asarray(values).astype(np.float32).astype(float)


def test_a_replay_arrives_whole(served):
    hidden = np.array(CAPTURE.markers.positions_m)
    hidden[5:9, 2] = np.nan
    capture = replace(CAPTURE, markers=replace(CAPTURE.markers, positions_m=hidden))
    player = served(capture)
    source = NatNetSource("127.0.0.1", "127.0.0.1", player.port, None)
    stream = connected(source)
    frames = read(source, 30)
    source.close()
    assert stream.marker_names == CAPTURE.markers.names
    assert (stream.rate_hz, stream.plate_rate_hz) == (100.0, 1000.0)
    for plate, original in zip(stream.plates, CAPTURE.plates, strict=True):
        assert plate.name == original.name
        np.testing.assert_allclose(plate.corners_m, original.corners_m, atol=1e-6)
        np.testing.assert_allclose(plate.origin_m, original.origin_m, atol=1e-6)
    assert [frame.number for frame in frames] == list(range(30))
    np.testing.assert_array_equal([frame.markers_m for frame in frames], single(hidden))
    wrench = np.concatenate([frame.plates.wrench for frame in frames])
    expected = np.concatenate([frame.plates.wrench for frame in frames_of(CAPTURE)[1]])
    np.testing.assert_allclose(wrench[: len(expected)], single(expected)[: len(wrench)], atol=1e-4)
    assert np.concatenate([frame.plates.index for frame in frames]).tolist() == list(range(300))


def test_points_without_names_arrive(served):
    player = served(unlabelled=True)
    source = NatNetSource("127.0.0.1", "127.0.0.1", player.port, None)
    stream = connected(source)
    (frame,) = read(source, 1)
    source.close()
    assert stream.marker_names == ()
    found, original = np.sort(frame.unlabelled_m, axis=0), np.sort(CAPTURE.markers.positions_m[0], axis=0)
    np.testing.assert_array_equal(found, single(original))


@pytest.mark.slow
def test_a_server_that_dies_and_returns_is_taken_up_again(served, monkeypatch):
    monkeypatch.setattr("mbkf.stream.natnet.source.RECONNECT_AFTER_S", 0.2)
    player = served()
    source = NatNetSource("127.0.0.1", "127.0.0.1", player.port, None)
    connected(source)
    assert len(read(source, 30)) == 30
    player._closing.set()
    player._thread.join()
    player._socket.close()
    assert source.read(0.3) is None
    again = served(port=player.port)
    assert again.port == player.port
    until(lambda: (frame := source.read(0.1)) is not None and frame.number == 29)
    source.close()
    assert {kind for kind, _ in source.news()} == {"connection"}


@pytest.fixture
def server():
    made = Server()
    yield made
    made.close()


def test_frames_follow_each_other_whatever_comes_between(server):
    source = NatNetSource("127.0.0.1", "127.0.0.1", server.port, None)
    assert source.connect(0.0) is None
    server.hear(packets.CONNECT)
    server.send(
        frame(0), *nonsense(), layouts.answer((9, 9)), layouts.answer((4, 1)), *nonsense(), described()
    )
    server.send(*(frame(k) for k in range(1, 10)))
    stream = connected(source)
    assert (stream.marker_names, stream.rate_hz) == (("A",), 100.0)
    for number in range(10, 20):
        server.send(*nonsense(), frame(number))
    frames = read(source, 20)
    assert [one.number for one in frames] == list(range(20))
    np.testing.assert_array_equal([one.markers_m[0, 0] for one in frames], 1.0 + np.arange(20))
    assert [kind for kind, _ in source.news()] == ["packets"]
    source.close()


def test_two_seconds_of_frames_are_held(server):
    source = NatNetSource("127.0.0.1", "127.0.0.1", server.port, None)
    source.connect(0.0)
    server.hear(packets.CONNECT)
    thousand = [layouts.frame((4, 1), k, 0.001 * k) for k in range(10)]
    server.send(layouts.answer((4, 1)), described(), *thousand)
    assert connected(source).rate_hz == 1000.0
    assert source._client.most_held == 2000
    source.close()


def test_an_address_that_is_gone_for_a_while_ends_nothing(server, monkeypatch):
    monkeypatch.setattr(source_module, "RECONNECT_AFTER_S", 0.0)
    source = NatNetSource("127.0.0.1", "127.0.0.1", server.port, None)
    source.connect(0.0)
    server.hear(packets.CONNECT)
    server.send(layouts.answer((4, 1)), described(), *(frame(k) for k in range(10)))
    connected(source)
    assert len(read(source, 10)) == 10

    def unplugged(*options):
        raise InvalidInput("NatNet: the network is gone")

    with monkeypatch.context() as patched:
        patched.setattr(source_module, "NatNetClient", unplugged)
        assert source.read(0.0) is None
        assert source.read(0.0) is None
    assert {what for _, what in source.news()} >= {"NatNet: the network is gone"}
    monkeypatch.setattr(source_module, "RECONNECT_AFTER_S", PATIENCE_S)
    source._again()
    server.heard()
    server.hear(packets.CONNECT)
    server.send(frame(30), layouts.answer((4, 1)))
    assert [one.number for one in read(source, 1)] == [30]
    source.close()


def test_without_a_server_nothing_is_found():
    source = NatNetSource("127.0.0.1", "127.0.0.1", 1, None)
    assert source.connect(0.1) is None
    source.close()


def test_what_cannot_be_served_is_refused():
    player = NatNetPlayer(played(CAPTURE), "127.0.0.1", 0)
    with pytest.raises(InvalidInput, match="cannot be served"):
        NatNetPlayer(played(CAPTURE), "127.0.0.1", player.port)
    player.close()
    many = MarkerTrajectories(tuple(map(str, range(3000))), np.ones((2, 3000, 3)), 100.0)
    with pytest.raises(InvalidInput, match="too large"):
        NatNetPlayer(played(replace(CAPTURE, markers=many)), "127.0.0.1", 0)


def test_a_description_that_changes_while_frames_come_is_asked_for_and_followed(server):
    """Two markers change places: frames between the server's notice and its description have no names."""

    def sent(number, first, second, flags=0):
        positions = [np.full(3, first), np.full(3, second)]
        whole = bytearray(layouts.frame((4, 1), number, 0.01 * number, [("one", positions)]))
        whole[-6:-4] = struct.pack("<H", flags)
        return bytes(whole)

    source = NatNetSource("127.0.0.1", "127.0.0.1", server.port, None)
    source.connect(0.0)
    server.hear(packets.CONNECT)
    server.send(layouts.answer((4, 1)), layouts.descriptions((4, 1), [("one", ("A", "B"))], ()))
    server.send(*(sent(k, 1.0, 2.0) for k in range(10)))
    assert connected(source).marker_names == ("A", "B")
    assert {tuple(frame.markers_m[:, 0]) for frame in read(source, 10)} == {(1.0, 2.0)}
    server.heard()
    server.send(sent(10, 2.0, 1.0, flags=2))
    (unsure,) = read(source, 1)
    assert np.isnan(unsure.markers_m).all() and not len(unsure.plates.index)
    server.hear(packets.REQUEST_DESCRIPTIONS)
    server.send(layouts.descriptions((4, 1), [("one", ("B", "A"))], ()))
    assert source._client.described.wait(PATIENCE_S)
    server.send(sent(11, 2.0, 1.0, flags=2))
    assert read(source, 1)[0].markers_m[:, 0].tolist() == [1.0, 2.0]
    source.close()


def test_a_server_that_was_silent_is_asked_again(server, monkeypatch):
    """It may have been started anew and send its markers in another order, without a notice."""
    source = NatNetSource("127.0.0.1", "127.0.0.1", server.port, None)
    source.connect(0.0)
    server.hear(packets.CONNECT)
    server.send(layouts.answer((4, 1)), described(), *(frame(k) for k in range(10)))
    connected(source)
    assert len(read(source, 10)) == 10
    server.heard()
    monkeypatch.setattr(source_module, "RESTART_FRAMES", 0)
    monkeypatch.setattr(source_module, "RESTART_S", 0.0)  # any time at all is a silence
    server.send(frame(10))
    assert not np.isnan(read(source, 1)[0].markers_m).any()  # it counted on: this computer was busy
    server.send(frame(40))
    assert np.isnan(read(source, 1)[0].markers_m).all()
    server.hear(packets.REQUEST_DESCRIPTIONS)
    source.close()
