"""A capture played by the simulated QTM arrives whole, and the source outlives everything that QTM may do."""

import socket
import struct
import threading

import numpy as np
import pytest

from benchmarks.streams.qualisys_server import CAMERAS_CHANGED, QtmServer
from mbkf.errors import InvalidInput
from mbkf.stream import reconnecting
from mbkf.stream.played import played
from mbkf.stream.qualisys import packets, waiting
from mbkf.stream.qualisys.client import Packet, QtmClient
from mbkf.stream.qualisys.source import QualisysSource
from tests.captures import made_capture
from tests.stream.reading import connected, read
from tests.waiting import PATIENCE_S, until

CAPTURE = made_capture(30)
HERE = "127.0.0.1"


class Laboratory:
    """A simulated QTM and a source that follows it."""

    def __init__(self, unlabelled=False, **options):
        self.played = played(CAPTURE, unlabelled)
        self.server = QtmServer(self.played)
        self.source = QualisysSource(HERE, self.server.port, **options)
        self.stream = connected(self.source)
        self.ask()

    def ask(self):
        """Lets the source ask for frames."""
        until(lambda: self.source.read(0.01) or self.server.listening())

    def frames(self, *numbers):
        """Sends some frames and returns those that arrive."""
        for frame in self.played.frames():
            if frame.number in numbers:
                self.server.send(frame, 0.0)
        return read(self.source, len(numbers))

    def event(self, kind):
        found = []

        def come():
            self.source.read(0.01)
            found.extend(self.source.news())
            return " ".join(sentence for one, sentence in found if one == kind)

        return until(come, lambda: f"{found}")

    def close(self):
        self.source.close()
        self.server.close()


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """A busy computer is no silence of QTM."""
    monkeypatch.setattr(reconnecting, "RECONNECT_AFTER_S", PATIENCE_S)


@pytest.fixture
def laboratory():
    opened = []

    def start(*args, **options):
        opened.append(Laboratory(*args, **options))
        return opened[-1]

    yield start
    for one in opened:
        one.close()


def single(values):
    return 1e-3 * np.asarray(1e3 * values).astype(np.float32).astype(float)


@pytest.mark.parametrize("over_udp", [False, True])
def test_a_capture_arrives_whole(laboratory, over_udp):
    one = laboratory(over_udp=over_udp)
    frames = one.frames(*range(30))
    assert (one.stream.marker_names, one.stream.rate_hz) == (CAPTURE.markers.names, 100.0)
    assert [frame.number for frame in frames] == list(range(30))
    np.testing.assert_allclose([f.markers_m for f in frames], single(one.played.markers_m), rtol=1e-15)
    for plate, original in zip(one.stream.plates, CAPTURE.plates, strict=True):
        np.testing.assert_allclose(plate.corners_m, original.corners_m, atol=1e-9)
    index = np.concatenate([frame.plates.index for frame in frames])
    assert index.tolist() == list(range(len(index))) and len(index) > 290
    wrench = np.concatenate([frame.plates.wrench for frame in frames])
    centred = [p.corners_m.mean(axis=0) for p in CAPTURE.plates]
    expected = one.played.wrench[: len(index)].copy()
    for k, plate in enumerate(CAPTURE.plates):
        expected[:, k, 3:] += np.cross(plate.origin_m - centred[k], expected[:, k, :3])
    np.testing.assert_allclose(wrench, expected, atol=1e-4)
    assert one.event("plates axes").endswith("axes of the plate")


def test_points_without_names_arrive(laboratory):
    one = laboratory(unlabelled=True)
    (frame,) = one.frames(3)
    assert one.stream.marker_names == ()
    np.testing.assert_allclose(frame.unlabelled_m, single(one.played.markers_m[3]), rtol=1e-15)


def test_labels_in_another_order_are_followed_by_name(laboratory):
    one = laboratory()
    order = np.arange(len(one.server.names))[::-1]
    one.server.names = [one.server.names[k] for k in order]
    one.server.played = played(CAPTURE)
    one.server.to_all(6, bytes([CAMERAS_CHANGED]))
    until(
        lambda: one.source.read(0.01) or one.source._described.stream.marker_names[0] == one.server.names[0]
    )
    frame = next(f for f in one.played.frames() if f.number == 4)
    shuffled = type(frame)(frame.number, frame.markers_m[order], frame.plates)
    one.server.send(shuffled, 0.0)
    (found,) = read(one.source, 1)
    np.testing.assert_allclose(found.markers_m, single(CAPTURE.markers.positions_m[4]), rtol=1e-15)


def test_residuals_follow_their_markers(laboratory):
    one = laboratory()
    known, frame = one.server.names, next(iter(one.played.frames()))
    one.server.names = [*known[1:], "NEW"]
    one.source._asked_s = 0.0
    one.server.to_all(6, bytes([CAMERAS_CHANGED]))
    until(lambda: one.source.read(0.01) or one.source._described.stream.marker_names[-1] == "NEW")
    rows = np.hstack([1e3 * frame.markers_m, np.arange(float(len(known)))[:, None]]).astype("<f4")
    component = struct.pack("<Ihh", len(rows), 0, 0) + rows.tobytes()
    payload = struct.pack("<QIIII", 0, 7, 1, 8 + len(component), 9) + component
    one.server.send_data(one.server.streaming()[0], payload)
    (found,) = read(one.source, 1)
    expected = [np.nan, *(1e-3 * k for k in range(len(known) - 1))]
    np.testing.assert_allclose(found.residuals_m, expected, rtol=1e-12)


def test_labels_of_somebody_else_are_refused_until_the_known_ones_return(laboratory):
    one = laboratory()
    known, one.server.names = one.server.names, [f"other_{name}" for name in one.server.names]
    one.server.to_all(6, bytes([CAMERAS_CHANGED]))
    assert "none of the known markers" in one.event("refused")
    one.server.names = known
    one.source._asked_s = 0.0
    one.server.to_all(6, bytes([CAMERAS_CHANGED]))
    until(lambda: one.source.read(0.01) or not one.source._known.refused)
    assert len(one.frames(5)) == 1


def test_a_label_more_leaves_markers_without_names_until_parameters_are_here(laboratory):
    one = laboratory()
    one.server.names = [*one.server.names, "NEW"]
    frame = next(iter(one.played.frames()))
    more = type(frame)(0, np.vstack([frame.markers_m, np.ones(3)]), frame.plates)
    one.server.send(more, 0.0)
    (first,) = read(one.source, 1)
    assert np.isnan(first.markers_m).all()
    until(
        lambda: (
            one.source.read(0.01) or len(one.source._described.stream.marker_names) == len(one.server.names)
        )
    )
    one.server.send(more, 0.0)
    (second,) = read(one.source, 1)
    np.testing.assert_allclose(second.markers_m, single(CAPTURE.markers.positions_m[0]), rtol=1e-15)


def test_a_server_that_dies_and_returns_is_taken_up_again(laboratory):
    one = laboratory()
    assert len(one.frames(0)) == 1
    port = one.server.port
    one.server.close()
    assert "made anew" in one.event("connection")
    one.server = QtmServer(one.played, port=port)
    one.ask()
    assert [frame.number for frame in one.frames(7)] == [7]
    assert "is back" in one.event("connection")


def test_a_silent_connection_is_made_anew(laboratory, monkeypatch):
    one = laboratory()
    monkeypatch.setattr(reconnecting, "RECONNECT_AFTER_S", 0.0)
    assert "silent" in one.event("connection")


@pytest.mark.parametrize("payload", [b"", b"\1", bytes(16) + b"\xff" * 50])
def test_packets_that_cannot_be_read_are_left_out(laboratory, payload):
    one = laboratory()
    one.server.to_all(3, payload)
    assert [frame.number for frame in one.frames(2)] == [2]
    if len(payload) < 16:
        assert "left out" in one.event("packets")


def test_bytes_that_are_no_packet_end_the_connection_and_a_new_one_is_made(laboratory):
    one = laboratory()
    one.server.raw_to_all(b"\xff" * 40)
    assert "bytes" in one.event("connection")
    one.ask()
    assert [frame.number for frame in one.frames(9)] == [9]


def test_forces_that_come_late_are_waited_for(laboratory, monkeypatch):
    """QTM hands on forces in chunks: a frame goes on once those of its time are here."""
    monkeypatch.setattr(waiting, "FORCES_WITHIN_S", PATIENCE_S)
    one = laboratory()
    first, second, third = (f for f in one.played.frames() if f.number < 3)
    one.frames(0)
    none = type(first.plates).none(2)
    for frame in (second, third):
        client = one.server.streaming()[0]
        one.server.send_data(client, one.server.data(type(first)(frame.number, frame.markers_m, none), (9,)))
    assert one.source.read(0.2) is None
    one.server.send_data(one.server.streaming()[0], one.server.data(second, (4,)))
    (found,) = read(one.source, 1)
    assert (found.number, found.plates.index.tolist()) == (1, second.plates.index.tolist())
    assert one.source.read(0.05) is None


def test_forces_without_frames_do_not_pile_up(laboratory, monkeypatch):
    monkeypatch.setattr(waiting, "HELD_SAMPLES", 20)
    one = laboratory()
    frames = [f for f in one.played.frames() if f.number in range(5)]
    for frame in frames:
        one.source._put(Packet(0.0, packets.DATA, one.server.data(frame, (4,))))
    assert sum(len(chunk.index) for chunk in one.source._waiting._samples) == 20
    assert one.source._waiting._samples[-1].index[-1] == frames[-1].plates.index[-1]


def test_frames_do_not_wait_for_ever_for_forces_numbered_otherwise(laboratory, monkeypatch):
    monkeypatch.setattr(waiting, "FORCES_WITHIN_S", 0.001)
    one = laboratory()
    one.frames(0)
    frame = next(f for f in one.played.frames() if f.number == 1)
    for number in range(500, 500 + waiting.MOST_VAIN):
        one.server.send_data(one.server.streaming()[0], one.server.data(frame, (9, 4), number))
    assert len(read(one.source, waiting.MOST_VAIN)) == waiting.MOST_VAIN
    assert "too late" in one.event("plates late")


def test_a_measurement_is_started_and_stopped(laboratory):
    one = laboratory(control="")
    assert one.server.measuring
    one.source.close()
    until(lambda: not one.server.measuring)
    assert [word.split()[0] for word in one.server.commands[-3:]] == [
        "StreamFrames",
        "Stop",
        "ReleaseControl",
    ]


def test_a_wrong_password_is_an_event_and_frames_flow(laboratory):
    one = laboratory(control="wrong")
    assert "Wrong or missing password" in one.event("control")
    assert not one.server.measuring and len(one.frames(3)) == 1


def test_an_older_qtm_is_spoken_to_in_its_version():
    server = QtmServer(played(CAPTURE), most_version="1.9")
    client = QtmClient(HERE, server.port)
    assert client.version == "1.8"
    assert [word for word in server.commands if word.startswith("Version")][-1] == "Version 1.8"
    client.close()
    server.close()


@pytest.mark.parametrize("greeting", [b"\x11\0\0\0\1\0\0\0" + b"220 mail\0", b"SSH-2.0-OpenSSH_9.6\r\n"])
def test_another_server_is_refused(greeting):
    listener = socket.create_server((HERE, 0))

    def greet():
        connection, _ = listener.accept()
        connection.sendall(greeting)
        connection.close()

    thread = threading.Thread(target=greet)
    thread.start()
    with pytest.raises(InvalidInput, match="is not QTM"):
        QtmClient(HERE, listener.getsockname()[1] - 1)
    thread.join()
    listener.close()


def test_a_qtm_that_is_not_there_is_waited_for():
    server = QtmServer(played(CAPTURE))
    port = server.port
    server.close()
    assert QualisysSource(HERE, port).connect(0.01) is None
