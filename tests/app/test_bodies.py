"""Bodies are bounded and streamed: one that is too long is refused, and a long file never lies in memory."""

import asyncio
import io
import json
from contextlib import contextmanager

import pytest
from starlette.requests import ClientDisconnect, Request

from mbkf.app.bodies import plain, read_body, stated_size, stream_body
from mbkf.app.failures import Refused
from mbkf.errors import InvalidInput


def request(chunks, **headers):
    """A request whose body comes in chunks; ``None`` for a client that leaves."""
    left = iter(chunks)
    ahead = []

    async def receive():
        chunk = next(left, b"")
        ahead.append(chunk)
        if chunk is None:
            return {"type": "http.disconnect"}
        return {"type": "http.request", "body": chunk, "more_body": chunk != b""}

    raw = [(key.replace("_", "-").encode(), value.encode()) for key, value in headers.items()]
    made = Request(
        {"type": "http", "method": "POST", "path": "/", "query_string": b"", "headers": raw}, receive
    )
    return made, ahead


@contextmanager
def kept(log):
    file = io.BytesIO()
    try:
        yield file
    except BaseException:
        log.append("dropped")
        raise
    log.append(file.getvalue())


def test_a_body_is_read_up_to_its_bound():
    made, _ = request([b"ab", b"cd"])
    assert asyncio.run(read_body(made, 4)) == b"abcd"
    endless, ahead = request(b"x" * 10 for _ in range(1000))
    with pytest.raises(Refused, match="are taken") as refused:
        asyncio.run(read_body(endless, 95))
    assert refused.value.status == 413 and len(ahead) == 10
    stated, ahead = request([b"ab"], content_length="96")
    with pytest.raises(Refused):
        asyncio.run(read_body(stated, 95))
    assert ahead == [] and stated_size(stated) == 96 and stated_size(made) is None


def test_a_file_is_written_chunk_by_chunk():
    log = []
    made, _ = request([b"ab", b"cd"])
    assert asyncio.run(stream_body(made, kept(log))) == 4 and log == [b"abcd"]
    for chunks, error in (([b"ab", None], ClientDisconnect), ([b"abcdef"], Refused)):
        log.clear()
        broken, _ = request(chunks)
        with pytest.raises(error):
            asyncio.run(stream_body(broken, kept(log), 5))
        assert log == ["dropped"]


@pytest.mark.parametrize("body", [b"", b"{", b"\xff\xfe", b"[" * 100_000, b'{"a": ' + b"1" * 5000 + b"}"])
def test_other_texts_are_no_json(body):
    with pytest.raises(InvalidInput, match="no JSON"):
        plain(body)


@pytest.mark.parametrize(
    "body", [b"NaN", b"[1e999]", b'{"a": "\\u0000"}', b'{"\\ud800": 1}', b'["\\udfff"]', b"1" + b"0" * 400]
)
def test_values_that_no_file_holds_are_refused(body):
    with pytest.raises(InvalidInput, match="no file can hold"):
        plain(body)


def test_plain_data_come_through():
    value = {"a": [1, 2.5, None, True, "é 😀"], "b": {"c": {}}}
    assert plain(json.dumps(value).encode()) == value
