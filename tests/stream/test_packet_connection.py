"""A connection to a server: bytes both ways, and its end."""

import socket

import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.packet_connection import PacketConnection

HERE = "127.0.0.1"
PATIENCE_S = 10.0


@pytest.fixture
def both():
    """A connection and the server's end of it."""
    with socket.create_server((HERE, 0)) as listener:
        connection = PacketConnection(HERE, listener.getsockname()[1], "the server ended it")
        served, _ = listener.accept()
        with served:
            yield connection, served
    connection.close()


def test_bytes_go_both_ways_and_are_kept_in_order(both):
    connection, served = both
    connection.send(b"question")
    assert served.recv(100) == b"question"
    for part in (b"ans", b"wer"):
        served.sendall(part)
        assert connection.wait(PATIENCE_S) == [connection.socket]
        connection.receive()
    assert connection.received == b"answer"
    assert connection.wait(0.0) == []


def test_another_socket_is_waited_for_beside_it(both):
    connection, _ = both
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as beside:
        beside.bind((HERE, 0))
        beside.sendto(b"x", beside.getsockname())
        assert connection.wait(PATIENCE_S, beside) == [beside]


def test_a_server_that_ends_is_an_error_in_its_words(both):
    connection, served = both
    served.close()
    connection.wait(PATIENCE_S)
    with pytest.raises(ConnectionResetError, match="the server ended it"):
        connection.receive()


def test_a_server_that_is_not_there_is_an_error():
    with socket.create_server((HERE, 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(OSError):
        PacketConnection(HERE, port, "")


@pytest.mark.parametrize("host", ["a..b", "x" * 64])
def test_a_name_that_no_computer_can_have_is_refused(host):
    with pytest.raises(InvalidInput, match="neither an address nor a computer's name"):
        PacketConnection(host, 801, "ended")
