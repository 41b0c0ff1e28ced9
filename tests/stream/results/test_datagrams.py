"""Results go out as datagrams: names once a second and every frame; nobody has to receive them."""

import json
import socket

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.results import datagrams
from mbkf.stream.results.datagrams import JSON, OSC, DatagramResults
from mbkf.stream.results.values import ResultValues
from tests.stream.results.test_websocket import MODEL, shown_frame
from tests.waiting import PATIENCE_S


@pytest.fixture
def receiver():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        one.settimeout(PATIENCE_S)
        yield one


def test_json_holds_names_and_every_frame(receiver):
    results = DatagramResults(ResultValues(MODEL), JSON, *receiver.getsockname())
    frames = [shown_frame(MODEL, number) for number in range(3)]
    for frame in frames:
        results.take(frame)
    results.close()
    names = json.loads(receiver.recv(65536))
    values = ResultValues(MODEL)
    assert (tuple(names["names"]), tuple(names["units"])) == (values.names, values.units)
    for frame in frames:
        message = json.loads(receiver.recv(65536))
        assert message["frame"] == frame.number and message["verdict"] is None
        found = np.array([np.nan if one is None else one for one in message["values"]])
        np.testing.assert_array_equal(found, values.row(frame))


def test_osc_holds_the_numbers(receiver):
    results = DatagramResults(ResultValues(MODEL), OSC, *receiver.getsockname())
    results.take(shown_frame(MODEL))
    results.close()
    bundle = receiver.recv(65536)
    assert bundle.startswith(b"#bundle\0") and f"/mbkf/{ResultValues(MODEL).names[0]}\0".encode() in bundle


def test_messages_that_are_too_large_are_stated_once(receiver, monkeypatch):
    told = []
    results = DatagramResults(ResultValues(MODEL), JSON, *receiver.getsockname(), told.append)
    monkeypatch.setattr(datagrams, "frame_message", lambda *_: {"values": [0] * 40_000})
    for number in range(3):
        results.take(shown_frame(MODEL, number))
    results.close()
    (sentence,) = told
    assert "messages of json are too large for a datagram" in sentence
    assert "names" in json.loads(receiver.recv(65536)), "smaller ones are sent"


def test_nobody_has_to_listen(receiver):
    place = receiver.getsockname()
    receiver.close()
    results = DatagramResults(ResultValues(MODEL), JSON, *place)
    for number in range(20):
        results.take(shown_frame(MODEL, number))
    results.close()
    assert results._thread._error is None


def test_a_place_that_is_none_is_refused():
    with pytest.raises(InvalidInput, match="cannot be sent to"):
        DatagramResults(ResultValues(MODEL), OSC, "300.1.1.1", 9)
