"""What the server replies: plain data as JSON, and a foreseen failure as one sentence."""

from __future__ import annotations

from collections.abc import Callable

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response

from mbkf.errors import InvalidInput, MbkfError


async def told(answer: Callable[[], object]) -> Response:
    """What a function returns as JSON; a foreseen failure as its sentence, under "trouble"."""
    try:
        return JSONResponse(await run_in_threadpool(answer))
    except MbkfError as error:
        return JSONResponse({"trouble": " ".join(str(error).split())}, status_code=400)
    except OSError as error:
        return JSONResponse({"trouble": error.strerror or str(error)}, status_code=500)


async def page(make: Callable[[], str]) -> Response:
    """A page that a function makes; a foreseen failure as its sentence."""
    try:
        return HTMLResponse(await run_in_threadpool(make))
    except MbkfError as error:
        return PlainTextResponse(" ".join(str(error).split()), status_code=404)


async def said(request: Request) -> object:
    """The plain data that a page says.

    Raises:
        InvalidInput: It is no JSON.
    """
    try:
        return await request.json()
    except (ValueError, RecursionError) as error:
        raise InvalidInput("the page said something that is no JSON") from error


def asked(request: Request, name: str) -> str:
    """A word of the request's address, e.g. ``session`` of ``?session=P1``; empty where it is missing."""
    return request.query_params.get(name, "")
