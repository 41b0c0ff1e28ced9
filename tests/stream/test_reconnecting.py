"""Renewal of a connection: attempts, events, and what a new connection is asked for."""

from typing import NamedTuple

import pytest

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream import reconnecting
from mbkf.stream.reconnecting import ReconnectingSource


class Packet(NamedTuple):
    arrival_s: float


class Client:
    def __init__(self, results):
        self.results, self.closed = results, False

    def take(self, _):
        result = self.results.pop(0)
        if isinstance(result, Exception):
            raise result
        return result

    def close(self):
        self.closed = True


class Source(ReconnectingSource):
    def __init__(self, *openings, known=True):
        super().__init__("the server")
        self._known = object() if known else None
        self.openings, self.resumed, self.breaks = list(openings), [], False

    def _open(self):
        result = self.openings.pop(0)
        if isinstance(result, Exception):
            raise result
        return result

    def _resume(self, client):
        self.resumed.append(client)
        if self.breaks:
            self._lose("gone")

    def take(self):
        return self._take(0.0)


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(reconnecting, "AGAIN_S", 0.0)
    monkeypatch.setattr(reconnecting, "RECONNECT_AFTER_S", float("inf"))


@pytest.mark.parametrize("error", [OSError("reset"), InvalidPacket("of 0 bytes")], ids=repr)
def test_a_connection_that_fails_is_closed_and_made_anew(error):
    first, second = Client([Packet(1.0), error]), Client([Packet(2.0)])
    source = Source(first, second)
    assert [source.take() for _ in range(5)] == [None, Packet(1.0), None, None, Packet(2.0)]
    assert first.closed and not second.closed and source.resumed == [first, second]
    (_, lost), (_, back) = source.news()
    assert lost == f"the connection to the server broke off and is made anew ({error})"
    assert back == "the connection to the server is back" and source.news() == []


def test_silence_ends_a_connection(monkeypatch):
    source = Source(Client([None]))
    monkeypatch.setattr(reconnecting, "RECONNECT_AFTER_S", -1.0)
    assert [source.take(), source.take()] == [None, None]
    ((kind, sentence),) = source.news()
    assert kind == "connection" and "it is silent" in sentence and source._client is None


def test_a_server_that_is_not_there_is_tried_again_without_events():
    good = Client([Packet(1.0)])
    source = Source(OSError("refused"), OSError("refused"), good)
    assert [source.take() for _ in range(4)] == [None, None, None, Packet(1.0)] and source.news() == []


def test_another_server_is_an_error_before_the_stream_is_known_and_an_event_after():
    with pytest.raises(InvalidInput, match="other"):
        Source(InvalidInput("other"), known=False).take()
    source = Source(InvalidInput("other"), InvalidInput("other"))
    source.take(), source.take()
    assert source.news() == [("refused", "the server cannot be connected to again (other)")]


def test_a_connection_that_breaks_off_while_it_is_resumed_is_not_back():
    source = Source(Client([]), Client([Packet(3.0)]))
    source.breaks = True
    source.take()
    assert [kind for kind, _ in source.news()] == ["connection"] and source._client is None
    source.breaks = False
    source.take()
    assert source.news() == [("connection", "the connection to the server is back")]


def test_attempts_are_apart(monkeypatch):
    source = Source(OSError("refused"), Client([]))
    source.take()
    monkeypatch.setattr(reconnecting, "AGAIN_S", 1e6)
    source.take()
    assert len(source.openings) == 1
