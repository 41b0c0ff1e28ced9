"""A simulated DataStream server is found at its port, described, and left alone; other servers are not listed."""

import socket
from contextlib import closing

from benchmarks.streams.vicon_server import BODY, ViconServer
from mbkf.stream.played import played
from mbkf.stream.vicon.discovery import vicon_streams
from tests.captures import made_capture
from tests.stream.discovering import HERE, answering


def test_a_program_that_streams_is_described_and_not_made_to_stream():
    with closing(ViconServer(played(made_capture(3)))) as server:
        (found,) = vicon_streams(30.0, HERE, server.port)
        assert not any(one.streaming for one in server.clients())
    assert (found.source, found.name) == (f"vicon:{HERE}:{server.port}", BODY)
    assert (found.markers, found.rate_hz, found.plates) == (36, 100.0, 2)


def test_a_program_without_frames_is_listed_without_contents(monkeypatch):
    monkeypatch.setattr(ViconServer, "send_blocks", lambda *_: None)
    with closing(ViconServer(played(made_capture(3)))) as server:
        (found,) = vicon_streams(0.5, HERE, server.port)
    assert found.markers is None and found.carries == "not known"


def test_another_server_and_a_closed_port_are_not_listed():
    with answering(b"HTTP/1.1 400 Bad Request\r\n\r\n") as port:
        assert vicon_streams(30.0, HERE, port) == []
    with socket.create_server((HERE, 0)) as server:
        port = server.getsockname()[1]
    assert vicon_streams(0.0, HERE, port) == []
