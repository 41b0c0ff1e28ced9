"""Bodies of requests: read up to a bound, or streamed into a file; never more of one in memory than its bound."""

from __future__ import annotations

import json
import math
from collections.abc import AsyncIterator
from contextlib import AbstractContextManager, asynccontextmanager
from typing import BinaryIO, TypeVar

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from mbkf.app.failures import TOO_LARGE, Refused
from mbkf.errors import InvalidInput

T = TypeVar("T")

MOST_BODY = 32 * 1024**2
"""Most bytes of a request in memory; 100,000 events of a trial, before and after a change, take 12 MB."""

MOST_UPLOAD = 16 * 1024**3
"""Most bytes of a dropped file; an hour of 60 markers and 8 plates at 2 kHz takes 4 GB."""


def stated_size(request: Request) -> int | None:
    """The size of a request's body by its headers, bytes; None for a body in chunks."""
    stated = request.headers.get("content-length", "")
    return int(stated) if stated.isascii() and stated.isdigit() else None


async def read_body(request: Request, most: int = MOST_BODY) -> bytes:
    """The body of a request.

    Raises:
        Refused: It is longer than the bound, bytes.
    """
    _check_size(stated_size(request), most)
    found = bytearray()
    async for chunk in request.stream():
        found += chunk
        _check_size(len(found), most)
    return bytes(found)


async def stream_body(
    request: Request, opened: AbstractContextManager[BinaryIO], most: int = MOST_UPLOAD
) -> int:
    """Writes the body of a request into a file chunk by chunk, in threads, so that other requests go on.

    Args:
        request: The request.
        opened: Opens the file, and puts it into its place at the end.
        most: Bound of the size, bytes.

    Returns:
        The size, bytes.

    Raises:
        Refused: The body is longer than the bound.
        OSError: The file cannot be written.
    """
    _check_size(stated_size(request), most)
    size = 0
    async with _in_threads(opened) as file:
        async for chunk in request.stream():
            size += len(chunk)
            _check_size(size, most)
            await run_in_threadpool(file.write, chunk)
    return size


def plain(body: bytes) -> object:
    """The plain data of a request's body.

    Raises:
        InvalidInput: The body holds no JSON, or a number or text that no file can hold.
    """
    try:
        found = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise InvalidInput("the page sent a request that is no JSON") from error
    try:
        _check(found)
    except (ValueError, OverflowError) as error:
        raise InvalidInput(
            "the request holds a number that is not finite, or a text that no file can hold"
        ) from error
    return found


def _check(value: object) -> None:
    """Passes values that a file can hold.

    Raises:
        ValueError: A text holds the letter NUL or half of a surrogate pair, or a number is not finite.
        OverflowError: A number is too large.
    """
    if isinstance(value, str):
        if "\0" in value:
            raise ValueError("a text with the letter NUL")
        value.encode("utf-8")
    elif isinstance(value, int | float):
        if not math.isfinite(float(value)):
            raise ValueError("a number that is not finite")
    elif isinstance(value, list):
        for one in value:
            _check(one)
    elif isinstance(value, dict):
        for key, one in value.items():
            _check(key)
            _check(one)


def _check_size(size: int | None, most: int) -> None:
    if size is not None and size > most:
        raise Refused(TOO_LARGE, f"the request has {_shown(size)}; at most {_shown(most)} are taken")


def _shown(size: int) -> str:
    return f"{size / 1e6:.0f} MB" if size < 1e10 else f"{size / 1e9:.0f} GB"


@asynccontextmanager
async def _in_threads(opened: AbstractContextManager[T]) -> AsyncIterator[T]:
    """A context whose beginning and end, which wait for the disk, run in threads."""
    value = await run_in_threadpool(opened.__enter__)
    try:
        yield value
    except BaseException as error:
        await run_in_threadpool(opened.__exit__, type(error), error, error.__traceback__)
        raise
    await run_in_threadpool(opened.__exit__, None, None, None)
