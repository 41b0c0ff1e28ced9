"""Routes whose replies are plain data as JSON, a page, or a file; a foreseen failure is replied as one sentence.

Notes carry a version: a reply with an entry ``version`` repeats it as its ``ETag``, and a request that changes a note
names the version that it began from in ``If-Match``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import TypeVar
from urllib.parse import quote

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from mbkf.app.bodies import plain, read_body
from mbkf.app.failures import (
    BAD_REQUEST,
    CONFLICT,
    NOT_FOUND,
    WITHOUT_VERSION,
    Refused,
    failed,
    failure,
    language_of,
)
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.files_read import own_files_read
from mbkf.viz.translation import translated_data

T = TypeVar("T")

Query = Mapping[str, str]
"""Words of a request's address, e.g. "P1" for ``session`` in ``?session=P1``; empty where a word is missing."""

SPOKEN = frozenset(
    {"line", "reasons", "reason", "scaled_why", "said", "left_out", "trouble", "values", "what", "todo"}
)
"""Entries of replies that hold texts of the library; they are said in the page's language."""

NO_VERSION = "a change must name the version that it began from; load the page again"


def data(path: str, answer: Callable[[Query], object]) -> Route:
    """A GET request that is replied to with plain data."""

    async def endpoint(request: Request) -> Response:
        return await replied(
            lambda: _json(answer(_query(request)), language_of(request)), language_of(request)
        )

    return Route(path, endpoint, methods=["GET"])


def action(path: str, answer: Callable[[Query, bytes], object]) -> Route:
    """A POST request with a body that is replied to with plain data."""

    async def endpoint(request: Request) -> Response:
        try:
            body = await read_body(request)
        except MbkfError as error:
            return failed(error, language_of(request))
        return await replied(
            lambda: _json(answer(_query(request), body), language_of(request)), language_of(request)
        )

    return Route(path, endpoint, methods=["POST"])


def change(path: str, answer: Callable[[Query, object, str], object]) -> Route:
    """A POST request that changes a note; ``answer`` gets the plain data of its body and the version in ``If-Match``.

    A reply with ``differences`` reports a change that somebody else's stands against.
    """

    async def endpoint(request: Request) -> Response:
        version = request.headers.get("if-match", "").removeprefix("W/").strip('"')
        try:
            body = await read_body(request)
            if not version:
                raise Refused(WITHOUT_VERSION, NO_VERSION)
        except MbkfError as error:
            return failed(error, language_of(request))
        language = language_of(request)
        return await replied(lambda: _json(answer(_query(request), plain(body), version), language), language)

    return Route(path, endpoint, methods=["POST"])


def page(path: str, make: Callable[[Query], str]) -> Route:
    """A GET request that is replied to with a page."""

    async def endpoint(request: Request) -> Response:
        try:
            return HTMLResponse(await in_own_thread(lambda: make(_query(request))))
        except (MbkfError, OSError) as error:
            status, text = failure(error, language_of(request))
            return PlainTextResponse(text, status_code=NOT_FOUND if status == BAD_REQUEST else status)

    return Route(path, endpoint, methods=["GET"])


def download(path: str, make: Callable[[Query], tuple[str, bytes]]) -> Route:
    """A GET request that is replied to with a file: its name and its content."""

    def answer(query: Query) -> Response:
        name, content = make(query)
        headers = {"Content-Disposition": f"attachment; filename*=utf-8''{quote(name, safe='')}"}
        return Response(content, media_type="application/octet-stream", headers=headers)

    async def endpoint(request: Request) -> Response:
        return await replied(lambda: answer(_query(request)), language_of(request))

    return Route(path, endpoint, methods=["GET"])


async def in_own_thread(work: Callable[[], T]) -> T:
    """The result of a function that runs in a thread; the files that it reads count for this request alone."""

    def alone() -> T:
        with own_files_read():
            return work()

    return await run_in_threadpool(alone)


async def replied(answer: Callable[[], Response], language: str) -> Response:
    """The reply of a function that runs in a thread; a foreseen failure as its sentence, under "trouble"."""
    try:
        return await in_own_thread(answer)
    except (MbkfError, OSError) as error:
        return failed(error, language)


def _json(answer: object, language: str) -> Response:
    answer = translated_data(answer, language, SPOKEN)
    entries = answer if isinstance(answer, Mapping) else {}
    headers = {"ETag": f'"{entries["version"]}"'} if "version" in entries else None
    return JSONResponse(answer, CONFLICT if entries.get("differences") else 200, headers)


def _query(request: Request) -> Query:
    """The words of a request's address.

    Raises:
        InvalidInput: One holds the letter NUL.
    """
    words = request.query_params
    if any("\0" in word for word in words.values()):
        raise InvalidInput("the address holds the letter NUL")
    return defaultdict(str, words)
