"""NatNet packets are read back by the client library, and a replay through it loses nothing but digits."""

import socket
import threading
import time
from dataclasses import replace

import natnet
import numpy as np
import pytest
from natnet.packet_buffer import PacketBuffer

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.player import NatNetPlayer, axes_of, plates_in_frames
from mbkf.stream.natnet.source import ROOM_BYTES, NatNetSource, read_all_corners
from mbkf.stream.played import played
from mbkf.stream.replay import ReplaySettings, replay
from tests.captures import made_capture
from tests.stream.scripted import frames_of

CAPTURE = made_capture(30)
VERSION = natnet.Version(*packets.VERSION)


def payload(packet, number):
    buffer = PacketBuffer(packet)
    assert (buffer.read_uint16(), buffer.read_uint16()) == (number, len(packet) - 4)
    return buffer


def test_descriptions_are_read_to_their_end():
    read_all_corners(natnet)
    read_all_corners(natnet)
    rng = np.random.default_rng(0)
    plates = [
        packets.PlateDescription(k, f"plate {k}", rng.normal(size=3), rng.normal(size=(4, 3))) for k in (1, 2)
    ]
    packet = packets.descriptions("walk", ("A", "Ä"), plates)
    buffer = payload(packet, packets.DESCRIPTIONS)
    found = natnet.DataDescriptions.read_from_buffer(buffer, VERSION)
    assert buffer.pointer == len(packet)
    assert found.marker_sets[0] == ("walk", ("A", "Ä"))
    for plate, made in zip(found.force_plates, plates, strict=True):
        assert (plate.id_num, plate.serial_number) == (made.number, made.serial)
        assert (plate.plate_type, plate.channel_data_type) == (2, 0)
        assert plate.channel_list == packets.CHANNELS
        np.testing.assert_array_equal(plate.corners, made.corners_m.astype(np.float32))
        np.testing.assert_array_equal(plate.position, made.offset_m.astype(np.float32))
        np.testing.assert_array_equal(plate.cal_matrix, np.eye(12))


def test_frames_are_read_back():
    rng = np.random.default_rng(1)
    markers, points = rng.normal(size=(4, 3)), rng.normal(size=(3, 3))
    markers[2] = np.nan
    plates = rng.normal(size=(2, 5, 6))
    packet = packets.frame(77, 0.77, "walk", markers, points, plates)
    buffer = payload(packet, packets.FRAME)
    found = natnet.DataFrame.read_from_buffer(buffer, VERSION)
    assert len(packet) - buffer.pointer == 4  # the tag at the end of data
    assert (found.prefix.frame_number, found.suffix.timestamp) == (77, 0.77)
    (only,) = found.marker_sets
    assert only.model_name == "walk"
    np.testing.assert_array_equal(only.marker_pos_list, np.nan_to_num(markers).astype(np.float32))
    np.testing.assert_array_equal(found.unlabeled_marker_pos, points.astype(np.float32))
    labelled = found.labeled_markers
    assert [marker.occluded for marker in labelled] == [False, False, True, False, False, False, False]
    assert [marker.unlabeled for marker in labelled] == 4 * [False] + 3 * [True]
    assert [marker.marker_id for marker in labelled[:4]] == [1, 2, 3, 4]
    for k, plate in enumerate(found.force_plates):
        assert plate.id_num == k + 1
        np.testing.assert_array_equal(np.array(plate.channel_arrays).T, plates[k].astype(np.float32))


def test_server_info_is_read_back():
    found = natnet.ServerInfo.read_from_buffer(
        payload(packets.server_info("us", 1510), packets.SERVER_INFO), None
    )
    assert found.application_name == "us"
    assert found.nat_net_protocol_version == VERSION


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


def connected(source):
    until = time.monotonic() + 10.0
    while time.monotonic() < until:
        stream = source.connect(0.5)
        if stream is not None:
            return stream
    raise AssertionError("no stream")


def read(source, count):
    frames, until = [], time.monotonic() + 5.0
    while len(frames) < count and time.monotonic() < until:
        frame = source.read(0.2)
        if frame is not None:
            frames.append(frame)
    return frames


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


def test_what_comes_while_nobody_reads_is_kept_for_long(served):
    """Both sockets have as much room as the system gives to whoever asks."""
    source = NatNetSource("127.0.0.1", "127.0.0.1", served().port, None)
    connected(source)
    sockets = [held for held in vars(source._client).values() if isinstance(held, socket.socket)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        usual = room_of(other)
        other.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM_BYTES)
        assert [room_of(one) for one in sockets] == 2 * [room_of(other)]
        assert room_of(other) > usual
    source.close()


def room_of(one):
    return one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)


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
    assert [frame.number for frame in read(source, 30)][-1] == 29
    source.close()
    assert {kind for kind, _ in source.news()} == {"connection"}


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
