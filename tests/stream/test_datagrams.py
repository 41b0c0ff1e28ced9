"""Datagrams are taken in order, those that waited can be let go of, and errors are sentences."""

import socket

import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.datagrams import Datagrams
from tests.waiting import PATIENCE_S


@pytest.fixture
def port():
    made = Datagrams("UDP", "127.0.0.1", 0)
    yield made
    made.close()


@pytest.fixture
def sender(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.connect(("127.0.0.1", port.port))
        yield one


def test_datagrams_come_in_order_with_their_sender(port, sender):
    sender.send(b"a")
    sender.send(b"b")
    one, other = port.take(PATIENCE_S), port.take(PATIENCE_S)
    assert (one.data, other.data, one.sender) == (b"a", b"b", sender.getsockname())
    assert one.arrival_s <= other.arrival_s
    assert port.take(0.0) is None


def test_those_that_wait_are_let_go_of(port, sender):
    sender.send(b"old")
    port.drop_waiting()
    sender.send(b"new")
    assert port.take(PATIENCE_S).data == b"new"


def test_an_event_is_reported_once(port):
    port.refuse("too short")
    port.refuse("too long")
    assert port.unreadable == 2
    assert port.news() == [("packets", "UDP: messages that cannot be read are left out (too short)")]
    assert port.news() == []


def test_a_taken_port_and_a_foreign_address_are_refused(port):
    with pytest.raises(InvalidInput, match="cannot be listened at"):
        Datagrams("UDP", "127.0.0.1", port.port)
    with pytest.raises(InvalidInput, match="--local names"):
        Datagrams("UDP", "192.0.2.1", 0)


def test_a_socket_that_is_gone_is_an_event(port):
    port.close()
    with pytest.raises(ValueError, match="file descriptor"):
        port.take(0.0)
