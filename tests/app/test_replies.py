"""Replies are JSON, a page or a file; foreseen failures are one sentence, others come through."""

import asyncio
import json

import pytest
from starlette.requests import Request

from mbkf.app.bodies import plain
from mbkf.app.replies import action, data, download, page
from mbkf.errors import InvalidInput

KINDS = {
    "data": (data, lambda do: lambda _query: do()),
    "action": (action, lambda do: lambda _query, _body: do()),
    "download": (download, lambda do: lambda _query: ("a.txt", do())),
}


def reply(route, query="", body=b""):
    """The reply of a route to a request."""

    async def receive():
        return {"type": "http.request", "body": body, "more_body": False}

    scope = {"type": "http", "method": "GET", "path": "/", "query_string": query.encode(), "headers": []}
    return asyncio.run(route.endpoint(Request(scope, receive)))


def failing(error):
    def answer(*_):
        raise error

    return answer


@pytest.mark.parametrize(
    ("error", "status", "trouble"),
    [
        (InvalidInput("two\n lines"), 400, "two lines"),
        (OSError(28, "No space left"), 507, "the disk is full; free some space and try again"),
        (OSError("odd"), 503, "the computer cannot read or write the file (odd)"),
    ],
)
@pytest.mark.parametrize("kind", KINDS)
def test_failures_are_one_sentence(kind, error, status, trouble):
    make, answered_by = KINDS[kind]
    found = reply(make("/x", answered_by(failing(error))))
    assert found.status_code == status and json.loads(found.body) == {"trouble": trouble}


@pytest.mark.parametrize("kind", KINDS)
def test_bugs_come_through(kind):
    make, answered_by = KINDS[kind]
    with pytest.raises(ZeroDivisionError):
        reply(make("/x", answered_by(failing(ZeroDivisionError()))))


def test_words_of_the_address_are_given_and_missing_ones_are_empty():
    found = reply(data("/x", lambda query: [query["session"], query["trial"]]), "session=P%201&other=2")
    assert json.loads(found.body) == ["P 1", ""]


def test_an_action_gets_the_body():
    found = reply(action("/x", lambda query, body: [query["do"], plain(body)]), "do=it", b'{"a": 1}')
    assert json.loads(found.body) == ["it", {"a": 1}]
    for body in (b"", b"{", b"\xff\xfe", b"[" * 100_000):
        found = reply(action("/x", lambda _query, body: plain(body)), body=body)
        assert found.status_code == 400 and "cannot be read" in json.loads(found.body)["trouble"]


def test_a_file_has_a_name_of_any_letters():
    found = reply(download("/x", lambda _query: ('é "x".c3d', b"content")))
    assert found.body == b"content"
    assert found.headers["Content-Disposition"] == "attachment; filename*=utf-8''%C3%A9%20%22x%22.c3d"


def test_pages():
    good, bad = reply(page("/x", lambda _: "<p>")), reply(page("/x", failing(InvalidInput("no such trial"))))
    assert (good.status_code, good.body, bad.status_code, bad.body) == (200, b"<p>", 404, b"no such trial")
