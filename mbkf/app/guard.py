"""Protection of the page's server: only this computer's own browser with the token of this run gets a reply.

Every request must name this computer as its host, must not come from another web page, and must carry the token, which
the first address brings and a cookie keeps.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from starlette.middleware.base import BaseHTTPMiddleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp

from mbkf.app.failures import language_of
from mbkf.stream.loopback import own_request
from mbkf.viz.admission import ADMITTED, Admission
from mbkf.viz.sentences import said

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
        admission: Token, cookie and tickets.
    """

    def __init__(self, app: ASGIApp, admission: Admission) -> None:
        super().__init__(app)
        self._admission = admission

    async def dispatch(self, request: Request, call_next: Next) -> Response:
        """The reply, or a refusal; each with the headers of every reply."""
        reply = await self._reply(request, call_next)
        reply.headers.update(HEADERS)
        return reply

    async def _reply(self, request: Request, call_next: Next) -> Response:
        if not own_request(request.headers.get("host", ""), request.headers.get("origin"), local=True):
            return PlainTextResponse("Refused.\n", status_code=403)
        words = request.query_params
        if request.url.path == "/" and self._admission.admit(words.get("ticket", "")):
            return HTMLResponse(ADMITTED, headers={"Set-Cookie": self._admission.set_cookie()})
        if request.url.path == "/" and self._admission.is_token(words.get("token", "")):
            return RedirectResponse("/", 303, headers={"Set-Cookie": self._admission.set_cookie()})
        if not self._admission.has_cookie(request.headers.get("cookie", "")):
            text = said("Open the address that mbkf app printed.", language_of(request))
            return PlainTextResponse(f"{text}\n", status_code=403)
        return await call_next(request)
