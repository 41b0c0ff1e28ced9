"""Protection of the page's server: only this computer's own browser with the token of this run gets a reply.

Every request must name this computer as its host, must not come from another web page, and must carry the token, which
the first address brings and a cookie keeps.
"""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable

from starlette.middleware.base import BaseHTTPMiddleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp

from mbkf.stream.loopback import own_request

Next = Callable[[Request], Awaitable[Response]]

HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "SAMEORIGIN",
}
"""Headers of every reply."""


class Guard(BaseHTTPMiddleware):
    """Refuses requests of other hosts, of other web pages, and without the token.

    Args:
        app: The application that it protects.
        token: Secret that every request must carry.
        cookie: Name of the cookie that carries it.
    """

    def __init__(self, app: ASGIApp, token: str, cookie: str) -> None:
        super().__init__(app)
        self._token, self._cookie = token, cookie

    async def dispatch(self, request: Request, call_next: Next) -> Response:
        """The reply, or a refusal."""
        if not own_request(request.headers.get("host", ""), request.headers.get("origin"), local=True):
            return PlainTextResponse("Refused.\n", status_code=403)
        if request.url.path == "/" and self._is_token(request.query_params.get("token", "")):
            opened = RedirectResponse("/", status_code=303)
            opened.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            return opened
        if not self._is_token(request.cookies.get(self._cookie, "")):
            return PlainTextResponse("Open the address that mbkf app printed.\n", status_code=403)
        reply = await call_next(request)
        reply.headers.update(HEADERS)
        return reply

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self._token.encode())
