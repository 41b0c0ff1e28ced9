"""The client outlives whatever is sent to it, hears what it should where it should, and holds what is not read yet."""

import socket
import time

import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.natnet import client as client_module
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.client import LEAST_HELD, ROOM_BYTES, NatNetClient
from mbkf.stream.natnet.frames import read_frame
from tests.stream.natnet import layouts
from tests.stream.natnet.serving import Server, described, frame, nonsense

PATIENCE_S = 5.0


@pytest.fixture
def server():
    made = Server()
    yield made
    made.close()


@pytest.fixture
def client(server):
    made = NatNetClient("127.0.0.1", "127.0.0.1", server.port, None)
    yield made
    made.close()


def introduced(server, client, version=(4, 1)):
    """Goes on after the server's answer and its description."""
    server.hear(packets.CONNECT)
    server.send(layouts.answer(version))
    server.hear(packets.REQUEST_DESCRIPTIONS)
    server.send(described(version))
    assert client.described.wait(PATIENCE_S)


def numbers(client, count):
    return [read_frame(client.take(PATIENCE_S)[1], client.version).number for _ in range(count)]


def test_a_server_is_asked_for_what_it_has_not_told(server, client):
    introduced(server, client)
    assert client.version == (4, 1)
    assert [one.name for one in client.descriptions.sets] == ["one"]
    before_s = time.perf_counter()
    server.send(frame(1), frame(2))
    arrival_s, packet = client.take(PATIENCE_S)
    assert before_s <= arrival_s <= time.perf_counter()
    assert packet == frame(1)
    assert numbers(client, 1) == [2]
    assert client.take(0.0) is None
    assert client.news() == []


def test_packets_of_another_sender_are_left_out_and_told_once(server, client):
    introduced(server, client)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.2", 0))
        for _ in range(3):
            stranger.sendto(frame(7), server.client)
            stranger.sendto(layouts.answer((3, 0)), server.client)
    server.send(frame(1), frame(2))
    assert numbers(client, 2) == [1, 2]
    assert (client.take(0.0), client.version) == (None, (4, 1))
    assert [kind for kind, _ in client.news()] == ["stranger"]


def test_a_server_may_answer_from_another_address_than_it_is_asked_at(client):
    assert client._ours("10.0.0.2")
    assert not client._ours("10.0.0.3")
    assert client._ours("127.0.0.1")  # its own, after all
    assert not client._ours("10.0.0.2")


def test_nothing_that_is_sent_ends_it(server, client):
    server.hear(packets.CONNECT)
    server.send(*nonsense(), described(), layouts.answer((77, 1)), layouts.cut(layouts.answer((4, 1)), 100))
    server.send(layouts.answer((4, 1)))
    server.hear(packets.REQUEST_DESCRIPTIONS)
    server.send(*nonsense(), layouts.cut(described(), 40), layouts.answer((3, 0)))
    server.hear(packets.REQUEST_DESCRIPTIONS)
    server.send(described(), *nonsense(), frame(9))
    assert client.described.wait(PATIENCE_S)
    assert client.version == (4, 1)
    packet = client.take(PATIENCE_S)[1]
    while packet != frame(9):
        packet = client.take(PATIENCE_S)[1]
    assert client.unreadable > 0
    ((kind, what),) = client.news()
    assert (kind, client.news()) == ("packets", [])
    assert "cannot be read" in what


def test_frames_before_the_answer_are_kept(server, client):
    server.hear(packets.CONNECT)
    server.send(frame(1), frame(2), layouts.answer((4, 1)), frame(3))
    assert client.answered.wait(PATIENCE_S)
    assert numbers(client, 3) == [1, 2, 3]


def test_the_latest_frames_are_held_and_dropped_ones_counted(server, client):
    introduced(server, client)
    client.described.clear()
    for number in range(LEAST_HELD + 40):
        server.send(frame(number))
        if number % 50 == 49:
            received(server, client)
    received(server, client)
    assert client.dropped == 40
    assert [kind for kind, _ in client.news()] == ["overrun"]
    assert numbers(client, LEAST_HELD) == list(range(40, 40 + LEAST_HELD))


def received(server, client):
    """Waits until all that was sent has been received."""
    client.described.clear()
    server.send(described())
    assert client.described.wait(PATIENCE_S)


def test_what_comes_before_the_answer_is_dropped_quietly(server, client):
    server.hear(packets.CONNECT)
    client.most_held = 2
    server.send(*(frame(k) for k in range(6)), layouts.answer((4, 1)))
    assert client.answered.wait(PATIENCE_S)
    assert numbers(client, 2) == [4, 5]
    assert (client.dropped, client.news()) == (0, [])


def test_the_server_hears_of_it_by_the_clock_not_by_the_packet(server, monkeypatch):
    monkeypatch.setattr(client_module, "KEEP_ALIVE_S", 0.02)
    made = NatNetClient("127.0.0.1", "127.0.0.1", server.port, None)
    introduced(server, made)
    server.hear(packets.KEEP_ALIVE)
    monkeypatch.setattr(client_module, "KEEP_ALIVE_S", 1000.0)
    server.send(*(frame(k) for k in range(100)))
    numbers(made, 100)
    assert server.heard().count(packets.KEEP_ALIVE) <= 2  # those that were due already
    made.close()
    server.hear(packets.DISCONNECT)


def test_both_sockets_listen_at_the_address_asked_for_with_much_room(client):
    """They have as much room as the system gives to anyone who asks."""
    sockets = own_sockets(client)
    assert [one.getsockname()[0] for one in sockets] == ["127.0.0.1", "127.0.0.1"]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        usual = room_of(other)
        other.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM_BYTES)
        assert [room_of(one) for one in sockets] == 2 * [room_of(other)]
        assert room_of(other) > usual


def own_sockets(client):
    return [held for held in vars(client).values() if isinstance(held, socket.socket)]


def room_of(one):
    return one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)


def test_frames_come_to_either_socket(server, client):
    introduced(server, client)
    for one in own_sockets(client):
        server.client = one.getsockname()
        server.send(frame(7))
        assert numbers(client, 1) == [7]


def test_a_group_is_joined(server):
    group = "239.255.42.98"
    try:
        made = NatNetClient("127.0.0.1", "127.0.0.1", server.port, group)
    except InvalidInput as error:
        pytest.skip(f"no multicast here: {error}")
    introduced(server, made)
    assert own_sockets(made)[0].getsockname()[0] == "127.0.0.1"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        sender.sendto(frame(5), (group, server.port + 1))
    assert numbers(made, 1) == [5]
    made.close()


@pytest.mark.parametrize(
    ("server", "local", "port", "multicast", "fragment"),
    [
        ("127.0.0.1", "203.0.113.7", 1510, None, "nothing can be received at 203.0.113.7"),
        ("127.0.0.1", "127.0.0.1", 1510, "127.0.0.1", "in the group 127.0.0.1"),
        ("127.0.0.1", "127.0.0.1", 1510, "no group", "no group"),
        ("127.0.0.1", "127.0.0.1", 70000, None, "port 70000 cannot be reached"),
        ("x" * 70 + ".y", "127.0.0.1", 1510, None, "--server and --local"),
    ],
)
def test_wrong_addresses_are_refused(server, local, port, multicast, fragment):
    with pytest.raises(InvalidInput, match=fragment):
        NatNetClient(server, local, port, multicast)
