"""A question reaches the servers of the network, and each computer's answers are taken once."""

import socket
import threading
from contextlib import closing

import pytest

from mbkf.stream import asking
from mbkf.stream.asking import asked, own_addresses

HERE = "127.0.0.1"


class Server:
    """Answers every question with some datagrams."""

    def __init__(self, *answers):
        self.questions, self._answers = [], answers
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((HERE, 0))
        self.port = self._socket.getsockname()[1]
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self):
        while True:
            question, sender = self._socket.recvfrom(100)
            if question == b"end":
                return
            self.questions.append((int(question), sender[1]))
            for one in self._answers:
                self._socket.sendto(one, sender)

    def close(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
            one.sendto(b"end", (HERE, self.port))
        self._thread.join()
        self._socket.close()


@pytest.fixture
def at_home(monkeypatch):
    """No other computer is asked."""
    monkeypatch.setattr(asking, "own_addresses", lambda _: [HERE])


def ask(server, most, monkeypatch):
    monkeypatch.setattr(asking, "MOST_ANSWERS", most)  # so that the search ends with the last answer
    return asked(lambda port: str(port).encode(), server.port, HERE, 30.0)


def test_each_answer_is_taken_once_and_the_question_names_its_port(at_home, monkeypatch):
    with closing(Server(b"one", b"one", b"two")) as server:
        found = ask(server, 2, monkeypatch)
        assert [(one.address, one.local, one.data) for one in found] == [
            (HERE, HERE, b"one"),
            (HERE, HERE, b"two"),
        ]
        ((stated, came_from),) = server.questions
        assert stated == came_from


def test_answers_without_end_are_not_all_taken(at_home, monkeypatch):
    with closing(Server(*(b"%d" % k for k in range(50)))) as server:
        assert len(ask(server, 10, monkeypatch)) == 10


def test_an_address_that_is_gone_is_left_out(monkeypatch):
    monkeypatch.setattr(asking, "own_addresses", lambda _: ["192.0.2.1", HERE])
    with closing(Server(b"one")) as server:
        assert [one.data for one in ask(server, 1, monkeypatch)] == [b"one"]


def test_a_given_network_is_asked_beside_the_own_one():
    assert {HERE, "192.0.2.7"} <= set(own_addresses("192.0.2.7"))
    assert "0.0.0.0" not in own_addresses("0.0.0.0")
    assert HERE in own_addresses("nowhere.invalid")


def test_a_computer_that_does_not_know_its_own_name_asks_the_given_network(monkeypatch):
    def unknown(*_):
        raise socket.gaierror("name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    assert own_addresses("192.0.2.7") == [HERE, "192.0.2.7"]
