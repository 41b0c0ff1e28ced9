"""A capture sent as JSON lines arrives whole and to the last bit; other senders and other streams do not enter."""

import json
import socket
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.stream import datagrams
from mbkf.stream.played import played
from mbkf.stream.udp.player import UdpPlayer, description, line
from mbkf.stream.udp.source import UdpSource
from tests.captures import made_capture
from tests.stream.reading import connected, read
from tests.waiting import until

HERE = "127.0.0.1"
CAPTURE = made_capture(30)


class Sending:
    """A player and its source, which have described and opened themselves to each other."""

    def __init__(self, capture, unlabelled=False):
        self.played = played(capture, unlabelled)
        self.source = UdpSource(0, HERE)
        self.player = UdpPlayer(self.played, HERE, self.source.port)
        self.player.push(description(self.played))
        self.stream = connected(self.source)
        assert self.source.read(0.0) is None and self.source.receiving

    def frames(self, *numbers, **changes):
        """Sends some frames and returns those that arrive."""
        chosen = [frame for frame in self.played.frames() if frame.number in numbers]
        for frame in chosen:
            self.player.push(self.player.fields(frame) | changes)
        return read(self.source, len(chosen))

    def event(self, kind):
        """The sentence of an event, once it has come."""
        found = {}

        def come():
            self.source.read(0.01)
            found.update(self.source.news())
            return found.get(kind)

        return until(come, lambda: f"{found}")

    def close(self):
        self.player.close()
        self.source.close()


@pytest.fixture
def sending():
    opened = []

    def start(capture=CAPTURE, unlabelled=False):
        opened.append(Sending(capture, unlabelled))
        return opened[-1]

    yield start
    for one in opened:
        one.close()


def test_a_capture_arrives_to_the_last_bit(sending):
    hidden = np.array(CAPTURE.markers.positions_m)
    hidden[5:9, 2] = np.nan
    one = sending(replace(CAPTURE, markers=replace(CAPTURE.markers, positions_m=hidden)))
    frames = one.frames(*range(30))
    assert (one.stream.marker_names, one.stream.rate_hz) == (CAPTURE.markers.names, 100.0)
    for plate, original in zip(one.stream.plates, CAPTURE.plates, strict=True):
        assert (plate.name, plate.rate_hz) == (original.name, original.rate_hz)
        np.testing.assert_array_equal(plate.corners_m, original.corners_m)
        np.testing.assert_array_equal(plate.origin_m, original.origin_m)
    assert [frame.number for frame in frames] == list(range(30))
    np.testing.assert_array_equal([frame.markers_m for frame in frames], hidden)
    sent = [frame.plates for frame in one.played.frames()]
    for name in ("index", "wrench"):
        np.testing.assert_array_equal(
            np.concatenate([getattr(frame.plates, name) for frame in frames]),
            np.concatenate([getattr(samples, name) for samples in sent]),
        )


def test_points_without_names_arrive(sending):
    one = sending(unlabelled=True)
    (frame,) = one.frames(3)
    assert one.stream.marker_names == () and frame.markers_m.shape == (0, 3)
    np.testing.assert_array_equal(frame.unlabelled_m, one.played.markers_m[3])


def test_other_units_and_axes_are_read(sending):
    """File x, y up, z towards the viewer: file (x, y, z) is world (x, −z, y)."""
    one = sending()
    turned = np.array([[1000, 0, 0], [0, 0, -1000], [0, 1000, 0]])
    places = ("origin", "corners")
    plates = [
        one | {key: (np.array(one[key]) @ turned).tolist() for key in places}
        for one in description(one.played)["plates"]
    ]
    one.player.push({"unit": "mm", "moment_unit": "N mm", "up": "y", "plates": plates})
    name = CAPTURE.markers.names[0]
    (frame,) = one.frames(0, markers={name: [100, 900, -20]}, forces=[[[1, 2, 3, 4000, 5000, 6000]] * 2])
    np.testing.assert_allclose(frame.markers_m[0], [0.1, 0.02, 0.9])
    assert np.isnan(frame.markers_m[1:]).all()
    np.testing.assert_allclose(frame.plates.wrench, [[[1, -3, 2, 4, -6, 5]] * 2])


def test_samples_without_a_frame_come_with_the_next_one(sending):
    one = sending()
    sample = [[[0, 0, 700, 0, 0, 0], [0, 0, 10, 0, 0, 0]]]
    one.player.push({"sample": 30, "forces": sample})
    one.player.push({"sample": 31, "forces": sample})
    (frame,) = one.frames(3, sample=32, forces=sample)
    assert frame.plates.index.tolist() == [30, 31, 32]
    assert frame.plates.wrench[0, :, 2].tolist() == [700.0, 10.0]


def test_samples_without_a_number_belong_to_their_frame(sending):
    one = sending()
    (frame,) = one.frames(3, sample=None, forces=[[[0] * 6] * 2] * 10)
    assert frame.plates.index.tolist() == list(range(30, 40))


def test_a_sender_that_lists_nothing_is_known_by_its_first_frames():
    source = UdpSource(0, HERE)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for number in range(10):
            markers = {"A": [0, 0, 1]} | ({"B": [1, 0, 1]} if number == 4 else {})
            text = json.dumps({"rate": 200, "frame": number, "markers": markers})
            sender.sendto(text.encode(), (HERE, source.port))
        stream = connected(source)
    source.close()
    assert (stream.marker_names, stream.rate_hz, stream.plates) == (("A", "B"), 200.0, ())


def test_a_sender_without_a_rate_is_refused(monkeypatch):
    monkeypatch.setattr("mbkf.stream.udp.source.DESCRIBED_S", -1.0)
    source = UdpSource(0, HERE)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(b'{"frame": 1, "markers": {"A": [0, 0, 1]}}', (HERE, source.port))
        with pytest.raises(InvalidInput, match="states no rate"):
            connected(source)
    source.close()


def test_renamed_markers_are_refused_until_the_known_names_return(sending):
    one = sending()
    name = CAPTURE.markers.names[0]
    one.player.push({"names": [f"other_{name}"]})
    assert "none of the known markers" in one.event("refused")
    one.player.push(one.player.fields(next(one.played.frames())))
    one.player.push({"names": [name]})
    assert len(one.frames(5)) == 1
    assert "are gone" in one.event("markers")


def test_a_description_that_cannot_be_is_left_out_until_it_is_right(sending):
    one = sending()
    one.player.push({"unit": "parsec"})
    assert "parsec" in one.event("refused")
    one.player.push({"unit": "m"})
    (frame,) = one.frames(4)
    np.testing.assert_array_equal(frame.markers_m, CAPTURE.markers.positions_m[4])


def test_what_cannot_be_read_is_left_out_and_reported_once(sending):
    one = sending()
    for wrong in (
        b"{",
        b"\xff" * 60_000,
        b'{"frame": 1, "markers": {"%s": [1, 2]}}' % one.stream.marker_names[0].encode(),
    ):
        one.player.push_bytes(wrong)
    one.player.push(one.player.fields(next(one.played.frames())) | {"forces": [[[0] * 6]]})
    assert [frame.number for frame in one.frames(7)] == [7]
    assert [kind for kind, _ in one.source.news()] == ["packets"]
    assert one.source._datagrams.unreadable == 4


def test_messages_of_another_sender_are_left_out(sending, monkeypatch):
    monkeypatch.setattr(datagrams, "SILENT_S", 1e9)
    one = sending()
    stranger = UdpPlayer(one.played, HERE, one.source.port)
    stranger.push(stranger.fields(next(one.played.frames())))
    assert [frame.number for frame in one.frames(8)] == [8]
    stranger.close()
    assert "are left out" in one.event("stranger")


def test_a_sender_that_was_started_anew_is_followed(sending, monkeypatch):
    monkeypatch.setattr(datagrams, "SILENT_S", -1.0)
    one = sending()
    one.player.close()
    one.player = UdpPlayer(one.played, HERE, one.source.port)
    assert [frame.number for frame in one.frames(0)] == [0]
    assert "another sender" in one.event("sender")


def test_a_player_knows_a_closed_port():
    source = UdpSource(0, HERE)
    player = UdpPlayer(played(CAPTURE), HERE, source.port)
    until(player.listening)
    source.close()
    until(lambda: not player.listening())
    player.close()


def test_a_frame_that_fits_into_no_datagram_is_refused():
    many = np.random.default_rng(0).normal(size=(1, 1200, 3))
    names = tuple(f"M{k}" for k in range(1200))
    markers = replace(CAPTURE.markers, names=names, positions_m=many)
    with pytest.raises(InvalidInput, match="65 kB"):
        UdpPlayer(played(replace(CAPTURE, markers=markers, plates=())), HERE, 9)


def test_a_line_is_one_line():
    assert line({"frame": 1, "markers": {"A": None}}) == b'{"frame":1,"markers":{"A":null}}\n'
