"""Commands and their answers, with packets of data between them."""

import struct

import pytest

from benchmarks.streams.qualisys_server import QtmServer
from mbkf.errors import InvalidInput
from mbkf.stream.packet_connection import PacketConnection
from mbkf.stream.played import played
from mbkf.stream.qualisys import client as client_module
from mbkf.stream.qualisys import packets
from mbkf.stream.qualisys.client import QtmClient
from tests.captures import made_capture
from tests.waiting import PATIENCE_S, until


@pytest.fixture
def server():
    made = QtmServer(played(made_capture(10)))
    yield made
    made.close()


@pytest.fixture
def client(server):
    made = QtmClient("127.0.0.1", server.port)
    yield made
    made.close()


def test_data_between_a_command_and_its_answer_waits(server, client):
    server.to_all(packets.DATA, b"first")
    server.to_all(packets.EVENT, b"\1")
    assert client.command("QTMVersion").startswith("QTM Version")
    assert [client.take(PATIENCE_S).payload for _ in range(2)] == [b"first", b"\1"]


def test_a_packet_in_pieces_is_put_together(server, client):
    whole = struct.pack("<II", 8 + 6, packets.DATA) + b"pieces"
    server.raw_to_all(whole[:3])
    assert client.take(0.02) is None
    server.raw_to_all(whole[3:] + whole)
    assert [client.take(PATIENCE_S).payload for _ in range(2)] == [b"pieces", b"pieces"]


def test_data_without_end_are_no_answer(server, client, monkeypatch):
    monkeypatch.setattr(client_module, "ANSWER_S", 0.0)
    server.to_all(packets.DATA, b"first")
    until(lambda: client.take(0.01) is not None)
    server.to_all(packets.DATA, b"second")
    client._receive(PATIENCE_S)
    with pytest.raises(TimeoutError, match="does not answer"):
        client._answer()


def test_a_refusal_is_an_error(client):
    with pytest.raises(InvalidInput, match="Parse error"):
        client.command("Dance")


def test_the_parameters_are_here_from_the_start(client):
    assert client.parameters.startswith("<QTM_Parameters_Ver") and client.version == "1.25"


def test_answers_to_a_greeting_that_never_come_are_waited_for_no_longer_than_asked(server, monkeypatch):
    now = [0.0]

    def pass_time(_, timeout_s, beside):
        now[0] += timeout_s
        return []

    monkeypatch.setattr(PacketConnection, "wait", pass_time)
    monkeypatch.setattr(client_module.time, "perf_counter", lambda: now[0])
    with pytest.raises(TimeoutError):
        QtmClient("127.0.0.1", server.port, greeting_s=0.5)
    assert now == [0.5]
