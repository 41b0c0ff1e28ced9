"""Routes whose replies are plain data as JSON, a page, or a file; a foreseen failure is replied as one sentence."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable, Mapping
from urllib.parse import quote

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from mbkf.errors import InvalidInput, MbkfError

Query = Mapping[str, str]
"""Words of a request's address, e.g. "P1" for ``session`` in ``?session=P1``; empty where a word is missing."""

BAD_REQUEST, NOT_FOUND, SERVER_ERROR = 400, 404, 500


def data(path: str, answer: Callable[[Query], object]) -> Route:
    """A GET request that is replied to with plain data."""

    async def endpoint(request: Request) -> Response:
        return await replied(lambda: JSONResponse(answer(_query(request))))

    return Route(path, endpoint, methods=["GET"])


def action(path: str, answer: Callable[[Query, bytes], object]) -> Route:
    """A POST request with a body that is replied to with plain data."""

    async def endpoint(request: Request) -> Response:
        body = await request.body()
        return await replied(lambda: JSONResponse(answer(_query(request), body)))

    return Route(path, endpoint, methods=["POST"])


def page(path: str, make: Callable[[Query], str]) -> Route:
    """A GET request that is replied to with a page."""

    async def endpoint(request: Request) -> Response:
        try:
            return HTMLResponse(await run_in_threadpool(make, _query(request)))
        except MbkfError as error:
            return PlainTextResponse(sentence(error), status_code=NOT_FOUND)

    return Route(path, endpoint, methods=["GET"])


def download(path: str, make: Callable[[Query], tuple[str, bytes]]) -> Route:
    """A GET request that is replied to with a file: its name and its content."""

    def answer(query: Query) -> Response:
        name, content = make(query)
        headers = {"Content-Disposition": f"attachment; filename*=utf-8''{quote(name, safe='')}"}
        return Response(content, media_type="application/octet-stream", headers=headers)

    async def endpoint(request: Request) -> Response:
        return await replied(lambda: answer(_query(request)))

    return Route(path, endpoint, methods=["GET"])


async def replied(answer: Callable[[], Response]) -> Response:
    """The reply of a function that runs in a thread; a foreseen failure as its sentence, under "trouble"."""
    try:
        return await run_in_threadpool(answer)
    except MbkfError as error:
        return JSONResponse({"trouble": sentence(error)}, status_code=BAD_REQUEST)
    except OSError as error:
        return JSONResponse({"trouble": error.strerror or str(error)}, status_code=SERVER_ERROR)


def sentence(error: Exception) -> str:
    """The text of an error in one line."""
    return " ".join(str(error).split())


def plain(body: bytes) -> object:
    """The plain data of a request's body.

    Raises:
        InvalidInput: The body holds no JSON.
    """
    try:
        return json.loads(body)
    except (ValueError, RecursionError) as error:
        raise InvalidInput("the page sent a request that is no JSON") from error


def _query(request: Request) -> Query:
    return defaultdict(str, request.query_params)
