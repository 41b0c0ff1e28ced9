"""The client's side of a connection: greeting, types asked for, single frames and all of them."""

import pytest

from benchmarks.streams.vicon_server import SHOWN, ViconServer
from mbkf.stream.played import played
from mbkf.stream.vicon import client as client_module
from mbkf.stream.vicon import objects
from mbkf.stream.vicon.client import ViconClient
from tests.captures import made_capture
from tests.waiting import until


@pytest.fixture
def pair():
    server = ViconServer(played(made_capture(5)))
    client = ViconClient("127.0.0.1", server.port)
    yield server, client
    client.close()
    server.close()


def test_it_asks_for_the_types_that_it_reads_and_the_server_has(pair):
    server, client = pair
    client.ask()
    packet = until(lambda: client.take(0.1))
    assert objects.FRAME_INFO in packet.blocks and not client.asked
    assert set(packet.blocks) <= set(objects.WANTED)
    assert 23 in client.supported and 23 not in packet.blocks
    assert not server.listening()


def test_single_frames_are_asked_for_one_by_one(pair):
    server, client = pair
    for _ in range(SHOWN):
        client.ask()
        until(lambda: client.take(0.1))
    assert client.take(0.0) is None and not server.listening()
    client.ask()
    until(server.listening)
    server.send(list(server.played.frames())[3], 0.0)
    assert until(lambda: client.take(0.1)).blocks[objects.FRAME_INFO] == [b"\3\0\0\0"]


def test_a_single_frame_that_does_not_come_is_asked_for_again(pair, monkeypatch):
    server, client = pair
    monkeypatch.setattr(client_module, "AGAIN_S", 0.0)
    server.send_blocks = lambda *_: None
    client.ask()
    until(lambda: client.take(0.0) or (server.ready() and server.ready()[0].asked > 1))


def test_all_frames_come_after_one_request(pair):
    server, client = pair
    client.stream()
    until(server.listening)
    for frame in server.played.frames():
        server.send(frame, 0.0)
    found = [until(lambda: client.take(0.1)) for _ in range(5)]
    assert [one.blocks[objects.FRAME_INFO][0][0] for one in found] == list(range(5))


def test_a_closed_connection_is_an_error(pair):
    server, client = pair
    server.close()
    with pytest.raises(OSError, match=r"ended the connection|reset"):
        until(lambda: client.take(0.1))
