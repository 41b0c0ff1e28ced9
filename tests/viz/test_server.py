"""The server: the page to those who may have it, the newest row to every socket, nothing to strangers."""

import json
import threading
import urllib.error
import urllib.request

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from mbkf.errors import InvalidInput
from mbkf.viz.server import PageServer
from tests.waiting import PATIENCE_S


@pytest.fixture
def rows():
    return [(0, b"first")]


@pytest.fixture
def server(rows):
    made = PageServer(
        "<p>page</p>", greeting=json.dumps({"hello": 1}), newest=lambda: rows[-1] if rows else None
    )
    yield made
    made.close()


@pytest.fixture
def guarded():
    made = PageServer("<p>secret</p>", newest=lambda: (0, b"row"), token="open sesame")
    yield made
    made.close()


def fetch(url, **headers):
    try:
        with urllib.request.urlopen(
            urllib.request.Request(url, headers=headers), timeout=PATIENCE_S
        ) as answer:
            return answer.status, answer.read().decode(), dict(answer.headers)
    except urllib.error.HTTPError as refusal:
        with refusal:
            return refusal.code, refusal.read().decode(), dict(refusal.headers)


def socket_of(url):
    return url.replace("http://", "ws://").replace("/?", "/frames?") if "?" in url else f"ws{url[4:]}frames"


def test_the_page_is_served_on_this_computer_alone(server):
    assert server.url.startswith("http://127.0.0.1:")
    status, text, headers = fetch(server.url)
    assert (status, text) == (200, "<p>page</p>")
    assert headers["Content-Type"].startswith("text/html") and headers["Cache-Control"] == "no-store"
    assert fetch(server.url + "other")[0] == 404


def test_a_socket_gets_the_greeting_and_then_the_newest_row(server, rows):
    with connect(socket_of(server.url)) as socket:
        assert json.loads(socket.recv(PATIENCE_S)) == {"hello": 1}
        assert socket.recv(PATIENCE_S) == b"first"
        rows += [(1, b"overtaken"), (2, b"second")]
        assert socket.recv(PATIENCE_S) == b"second"
        with pytest.raises(TimeoutError):
            socket.recv(0.2)


def test_several_pages_and_reopened_ones(server):
    for _ in range(2):
        with connect(socket_of(server.url)) as one, connect(socket_of(server.url)) as two:
            for socket in (one, two):
                socket.recv(PATIENCE_S)
                assert socket.recv(PATIENCE_S) == b"first"


def test_no_row_yet_is_waited_for(rows):
    first = rows.pop()
    server = PageServer("", greeting="hello", newest=lambda: rows[-1] if rows else None)
    with connect(socket_of(server.url)) as socket:
        assert socket.recv(PATIENCE_S) == "hello"
        rows.append(first)
        assert socket.recv(PATIENCE_S) == b"first"
    server.close()


def test_without_the_token_nothing_is_shown(guarded):
    bare = guarded.url.split("?")[0]
    assert fetch(guarded.url)[:2] == (200, "<p>secret</p>")
    for url in (bare, bare + "?token=", bare + "?token=wrong", bare + "?token=%C3%A9"):
        status, text, _ = fetch(url)
        assert status == 403
        assert "secret" not in text and "sesame" not in text
        with pytest.raises(InvalidStatus), connect(socket_of(url)):
            pass
    with connect(socket_of(guarded.url)) as socket:
        socket.recv(PATIENCE_S)
        assert socket.recv(PATIENCE_S) == b"row"


def test_a_browser_gets_a_cookie_and_an_address_without_the_token(guarded):
    bare, used = guarded.url.split("?")[0], []
    for url in (guarded.url, guarded.entrance(lambda: used.append(True))):
        status, text, headers = fetch(url, Accept="text/html")
        assert status == 200 and "location.replace" in text and "sesame" not in str(headers) + text
        assert "HttpOnly" in headers["Set-Cookie"] and "SameSite=strict" in headers["Set-Cookie"]
        cookie = headers["Set-Cookie"].partition(";")[0]
        assert fetch(bare, Cookie=cookie, Accept="text/html")[:2] == (200, "<p>secret</p>")
        assert fetch(bare, Cookie=cookie[:-1])[0] == 403
        assert fetch(bare, Cookie=cookie, Origin="http://evil.example")[0] == 403
        with connect(socket_of(bare), additional_headers={"Cookie": cookie}) as socket:
            socket.recv(PATIENCE_S)
    assert used == [True] and fetch(url)[0] == 403


def test_a_page_without_a_token_needs_no_ticket(server):
    assert server.entrance(pytest.fail) == server.url


def test_another_address_has_a_token_of_its_own():
    server = PageServer("page", address="0.0.0.0")
    try:
        port = server.url.split(":")[2].split("/")[0]
        token = server.url.split("token=")[1]
        assert len(token) > 16
        assert fetch(f"http://127.0.0.1:{port}/")[0] == 403
        assert fetch(f"http://127.0.0.1:{port}/?token={token}")[0] == 200
    finally:
        server.close()


def test_other_pages_and_other_names_of_this_computer_are_refused(server):
    host = server.url.split("/")[2]
    assert fetch(server.url, Origin="http://evil.example")[0] == 403
    assert fetch(server.url, Host="evil.example:80")[0] == 403
    assert fetch(server.url, Origin=f"http://{host}")[0] == 200
    with pytest.raises(InvalidStatus), connect(socket_of(server.url), origin="http://evil.example"):
        pass


def test_a_port_in_use_is_said(server):
    port = int(server.url.split(":")[2].strip("/"))
    with pytest.raises(InvalidInput, match=f"127.0.0.1:{port}.*choose another"):
        PageServer("", port=port)


def test_closing_ends_the_thread_and_the_sockets(rows):
    before = set(threading.enumerate())
    server = PageServer("", greeting="hello", newest=lambda: rows[-1])
    with connect(socket_of(server.url)) as socket:
        socket.recv(PATIENCE_S)
        server.close()
        server.close()
        server.wait()
        with pytest.raises(Exception, match=r"1001|closed|going away"):
            for _ in range(5):
                socket.recv(PATIENCE_S)
    for thread in set(threading.enumerate()) - before:
        thread.join(PATIENCE_S)  # the client's own ends a moment after its socket
    assert set(threading.enumerate()) <= before


def test_a_page_that_speaks_is_answered_word_by_word_and_the_next_page_too():
    server = PageServer("<p>page</p>", greeting="hello", hear=lambda word: word.upper(), token="open sesame")
    try:
        for words in (("a", "b"), ("c",)):
            with connect(socket_of(server.url)) as socket:
                assert socket.recv(PATIENCE_S) == "hello"
                for word in words:
                    socket.send(word)
                    assert socket.recv(PATIENCE_S) == word.upper()
                socket.send(b"no word")
                socket.send("last")
                assert socket.recv(PATIENCE_S) == "LAST"
    finally:
        server.close()


def test_a_page_that_only_looks_is_not_heard(server):
    with connect(socket_of(server.url)) as socket:
        socket.recv(PATIENCE_S)
        assert socket.recv(PATIENCE_S) == b"first"
        socket.send("word")
        with pytest.raises(TimeoutError):
            socket.recv(0.3)
