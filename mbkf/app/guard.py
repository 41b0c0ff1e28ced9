"""Who may ask the page's server: this computer's own browser, with the token of this run.

Every request must name this computer as it names itself, must not come from another web page, and must carry the token,
which the address that is opened first brings and a cookie keeps.
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
"""Headers of every answer."""


class Guard(BaseHTTPMiddleware):
    """Refuses what other names, other web pages or strangers ask for."""

    def __init__(self, app: ASGIApp, token: str, cookie: str) -> None:
        """Takes what to protect.

        Args:
            app: What answers requests that are let through.
            token: What every request must carry.
            cookie: Name of the cookie that carries it.
        """
        super().__init__(app)
        self._token, self._cookie = token, cookie

    async def dispatch(self, request: Request, call_next: Next) -> Response:
        """The answer, or a refusal."""
        if not own_request(request.headers.get("host", ""), request.headers.get("origin"), local=True):
            return PlainTextResponse("Refused.\n", status_code=403)
        if request.url.path == "/" and self._is_token(request.query_params.get("token", "")):
            opened = RedirectResponse("/", status_code=303)
            opened.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            return opened
        if not self._is_token(request.cookies.get(self._cookie, "")):
            return PlainTextResponse("Open the address that mbkf app printed.\n", status_code=403)
        answer = await call_next(request)
        answer.headers.update(HEADERS)
        return answer

    def _is_token(self, said: str) -> bool:
        return hmac.compare_digest(said.encode(), self._token.encode())
