"""A sender of JSON lines is found by listening; a port that another program has is no error."""

from contextlib import closing

from mbkf.stream import side_by_side
from mbkf.stream.played import played
from mbkf.stream.udp.discovery import udp_streams
from mbkf.stream.udp.player import UdpPlayer
from mbkf.stream.udp.source import UdpSource
from tests.captures import made_capture
from tests.stream.discovering import HERE
from tests.waiting import repeating


def test_a_sender_of_lines_is_heard(monkeypatch):
    monkeypatch.setattr(side_by_side, "own_addresses", lambda local: [local])
    with closing(UdpSource(0, HERE)) as one:
        port = one.port
    with closing(UdpPlayer(played(made_capture(3)), HERE, port)) as player, repeating(player.listening):
        (found,) = udp_streams(HERE, 30.0, port)
    assert (found.source, found.address, found.markers) == (f"udp:{port}", HERE, 36)
    assert found.options == {"local": HERE}


def test_a_port_that_is_taken_is_no_error():
    with closing(UdpSource(0, HERE)) as other:
        assert udp_streams(HERE, 0.0, other.port) == []
