"""Strangers and other web pages are refused."""

import pytest

from tests.app.asking import asked

PATHS = (
    "/", "/sessions", "/session?session=P1", "/trial/look?session=P1&trial=walk1", "/live/page",
    "/trial/export?session=P1&trial=walk1&to=c3d",
)  # fmt: skip


@pytest.mark.parametrize("path", PATHS)
def test_strangers_are_refused(server, cookie, path):
    own = f"127.0.0.1:{server.port}"
    for headers in (
        {},
        {"Cookie": cookie[:-1] + "x"},
        {"Cookie": cookie, "Host": "evil.example"},
        {"Cookie": cookie, "Origin": "http://evil.example"},
        {"Cookie": cookie, "Origin": "null"},
        {"Cookie": cookie, "Origin": "http://127.0.0.1:1"},
    ):
        assert asked(server, path, **headers)[0].status == 403, headers
    assert asked(server, "/?token=wrong")[0].status == 403
    good = asked(server, path, Cookie=cookie, Origin=f"http://{own}")[0]
    assert good.status in {200, 400, 404}
    assert good.headers["X-Content-Type-Options"] == "nosniff" and good.headers["Cache-Control"] == "no-store"


def test_a_ticket_admits_once_and_a_refusal_has_the_same_headers(server):
    used = []
    address = server.entrance(lambda: used.append(True)).partition(str(server.port))[2]
    answer, text = asked(server, address)
    assert answer.status == 200 and used == [True] and b"location.replace" in text
    told = answer.headers["Set-Cookie"]
    assert "HttpOnly" in told and "SameSite=strict" in told and server.url.partition("token=")[2] not in told
    assert asked(server, "/sessions", Cookie=told.partition(";")[0])[0].status == 200
    again = asked(server, address)[0]
    assert again.status == 403 and used == [True]
    for reply in (answer, again):
        assert (
            reply.headers["Referrer-Policy"] == "no-referrer" and reply.headers["Cache-Control"] == "no-store"
        )
