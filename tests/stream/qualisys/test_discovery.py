"""A simulated QTM is found and described, and does not stream by that."""

import struct
from contextlib import closing

import pytest

from benchmarks.streams.qualisys_server import QtmServer
from mbkf.stream.asking import Answer
from mbkf.stream.played import played
from mbkf.stream.qualisys import discovery
from mbkf.stream.qualisys.packets import COMMAND, packet
from tests.captures import made_capture
from tests.stream.discovering import HERE, answering, first_answer


def test_a_qtm_is_found_with_its_base_port_and_streams_nothing(monkeypatch):
    monkeypatch.setattr(discovery, "asked", first_answer)
    with closing(QtmServer(played(made_capture(3)), discover_port=0)) as server:
        (found,) = discovery.qualisys_streams(HERE, 30.0, server.discover_port)
        assert not server.listening()
    assert found.source == f"qualisys:{HERE}:{server.port}" and "QTM 2.17" in found.name
    assert (found.markers, found.rate_hz, found.plates) == (36, 100.0, 2)


def test_a_qtm_is_asked_at_its_place():
    with closing(QtmServer(played(made_capture(3)))) as server:
        (found,) = discovery.qualisys_at(HERE, server.port)
        assert not server.listening()
    assert (found.source, found.markers) == (f"qualisys:{HERE}:{server.port}", 36)
    assert discovery.qualisys_at(HERE, server.port) == [] and discovery.qualisys_at(HERE, 65535) == []


def test_servers_that_keep_silent_are_listed_without_contents(monkeypatch):
    monkeypatch.setattr(discovery, "DESCRIBED_S", 0.0)
    with answering(b"") as port:
        data = packet(COMMAND, b"QTM\0" + struct.pack(">H", port - 1))
        monkeypatch.setattr(discovery, "asked", lambda *_: [Answer(HERE, HERE, data)] * 2)
        found = discovery.qualisys_streams(HERE, 1.0)
    assert [one.markers for one in found] == [None] * 2


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"x" * 9,
        struct.pack("<II", 99, 1) + b"QTM\0ab",
        struct.pack("<II", 12, 6) + b"ab\x01\x02",
        packet(COMMAND, b"QTM\0\xff\xff"),  # there is no port after 65535
    ],
)
def test_another_answer_is_no_server(monkeypatch, data):
    monkeypatch.setattr(discovery, "asked", lambda *_: [Answer(HERE, HERE, data)])
    assert discovery.qualisys_streams(HERE, 1.0) == []
