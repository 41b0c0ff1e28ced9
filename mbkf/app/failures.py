"""Failures of requests as a status and one sentence: the one door through which errors become replies."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response
from starlette.types import ExceptionHandler

from mbkf.errors import MbkfError
from mbkf.io.utf8 import storable
from mbkf.viz.language import ENGLISH, languages
from mbkf.viz.sentences import said

BAD_REQUEST, FORBIDDEN, NOT_FOUND, CONFLICT, OVERTAKEN = 400, 403, 404, 409, 412
TOO_LARGE, WITHOUT_VERSION, SERVER_ERROR, UNAVAILABLE, DISK_FULL = 413, 428, 500, 503, 507

OF_SYSTEM = {
    errno.ENOSPC: (DISK_FULL, "the disk is full; free some space and try again"),
    errno.EDQUOT: (DISK_FULL, "the quota of the disk is used up; free some space and try again"),
    errno.EFBIG: (DISK_FULL, "the disk holds no file of this size"),
    errno.ENAMETOOLONG: (BAD_REQUEST, "the name is too long for this disk; choose a shorter one"),
    errno.ENOTDIR: (CONFLICT, "a file stands where a folder is needed; rename one of them"),
    errno.EEXIST: (CONFLICT, "a file stands where a folder is needed; rename one of them"),
    errno.EISDIR: (CONFLICT, "a folder stands where a file is needed; rename one of them"),
    errno.ENOTEMPTY: (CONFLICT, "a folder stands where a file is needed; rename one of them"),
    errno.EINVAL: (BAD_REQUEST, "this disk cannot hold a file of this name; rename it"),
    errno.EILSEQ: (BAD_REQUEST, "this disk cannot hold a file of this name; rename it"),
    errno.ELOOP: (BAD_REQUEST, "links on the way to the file lead in a circle"),
    errno.ENOENT: (NOT_FOUND, "the file or folder has been moved or removed; load the page again"),
    errno.EACCES: (FORBIDDEN, "this user may not read or write the file; change its permissions"),
    errno.EPERM: (FORBIDDEN, "this user may not read or write the file; change its permissions"),
    errno.EROFS: (FORBIDDEN, "the disk is mounted read-only; mount it for writing"),
    errno.EMFILE: (UNAVAILABLE, "too many files are open; close other programs and try again"),
    errno.ENFILE: (UNAVAILABLE, "too many files are open; close other programs and try again"),
}
"""Statuses and sentences for errors of the system."""


class Refused(MbkfError):
    """A request that the page's server does not carry out.

    Args:
        status: Of the reply.
        text: The reason, a sentence.
        key: Text ``refused_KEY`` of the language files that the page shows instead; empty without one.
        values: Values filled into that text.

    Attributes:
        status: Of the reply.
        key, values: As given.
    """

    def __init__(self, status: int, text: str, key: str = "", *values: str) -> None:
        self.status, self.key, self.values = status, key, values
        super().__init__(text)


def language_of(request: Request) -> str:
    """The language of the page that sends a request: in its address, or else in the header ``Accept-Language``."""
    asked = (request.query_params.get("language"), request.headers.get("accept-language", "")[:2])
    return next((one for one in asked if one and one in languages()), ENGLISH)


def failure(error: MbkfError | OSError, language: str = ENGLISH) -> tuple[int, str]:
    """The status and the sentence for a foreseen error, in a language."""
    status, text = _failure(error)
    return status, said(text, language)


def _failure(error: MbkfError | OSError) -> tuple[int, str]:
    if isinstance(error, Refused):
        return error.status, sentence(error)
    if isinstance(error, MbkfError):
        return BAD_REQUEST, sentence(error)
    status, text = OF_SYSTEM.get(error.errno or 0, (UNAVAILABLE, ""))
    if not text:
        text = (
            f"the computer cannot read or write the file ({error.strerror or error or type(error).__name__})"
        )
    name = Path(os.fsdecode(error.filename)).name if isinstance(error.filename, str | bytes) else ""
    return status, " ".join((f"{storable(name[:80])}: {text}" if name else text).split())


def failed(error: MbkfError | OSError, language: str = ENGLISH) -> Response:
    """The reply for a foreseen error: its sentence under "trouble", and its key and values where it has them."""
    status, text = failure(error, language)
    own: dict[str, object] = {}
    if isinstance(error, Refused) and error.key:
        own = {"key": f"refused_{error.key}", "values": list(error.values)}
    return JSONResponse({"trouble": text, **own}, status_code=status)


def sentence(error: Exception) -> str:
    """The text of an error in one line."""
    return storable(" ".join(str(error).split()))


async def _unforeseen(request: Request, error: Exception) -> Response:
    text = f"unforeseen {type(error).__name__} in mbkf; please report it with the steps that led here"
    return JSONResponse({"trouble": said(text, language_of(request))}, status_code=SERVER_ERROR)


async def _unknown_address(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    headers = dict(error.headers or {})
    text = "this address does not exist" if error.status_code == NOT_FOUND else f"refused ({error.detail})"
    return JSONResponse(
        {"trouble": said(text, language_of(request))}, status_code=error.status_code, headers=headers
    )


async def _left(request: Request, _error: Exception) -> Response:
    return JSONResponse(
        {"trouble": said("the request broke off", language_of(request))}, status_code=BAD_REQUEST
    )


HANDLERS: dict[int | type[Exception], ExceptionHandler] = {
    HTTPException: _unknown_address,
    ClientDisconnect: _left,
    Exception: _unforeseen,
}
"""Replies for errors that no route foresees."""
