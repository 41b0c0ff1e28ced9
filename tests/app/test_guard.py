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
