"""Admission to a page's server: a token that a cookie keeps, and tickets that admit a browser once.

An address with the token would stay in the browser's history, and in its command line where others read it. A ticket is
worthless after its use; a cookie that scripts and other sites never see then stands for the token.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
import threading
from collections.abc import Callable
from http.cookies import CookieError, SimpleCookie

MOST_TICKETS = 16
"""Most unused tickets at once."""

ADMITTED = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="referrer" content="no-referrer"><title>mbkf</title>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'">
<noscript><meta http-equiv="refresh" content="0;url=/"></noscript>
</head><body><script>history.replaceState(null, "", "/"); location.replace("/");</script></body></html>
"""
"""The page that a browser gets with its cookie; it leaves for the page itself, from an address without a secret.

A redirect would not do: browsers keep a strict cookie back from one that a page elsewhere began.
"""


def _nothing() -> None:
    """The default act after a ticket's use."""


class Admission:
    """The token of a server, its cookie and its tickets.

    Args:
        token: Secret of every request; empty for a server that anybody may read.
        cookie: Name of the cookie.
    """

    def __init__(self, token: str, cookie: str) -> None:
        self.token, self._cookie = token, cookie
        self._value = hashlib.sha256(b"mbkf cookie " + token.encode("utf-8", "replace")).hexdigest()
        self._tickets: dict[str, Callable[[], None]] = {}
        self._lock = threading.Lock()

    def ticket(self, used: Callable[[], None] = _nothing) -> str:
        """A new ticket.

        Args:
            used: Called when it has been used.
        """
        made = secrets.token_urlsafe(16)
        with self._lock:
            self._tickets[made] = used
            while len(self._tickets) > MOST_TICKETS:
                del self._tickets[next(iter(self._tickets))]
        return made

    def admit(self, ticket: str) -> bool:
        """True for a ticket that has not been used; it is used now."""
        with self._lock:
            used = self._tickets.pop(ticket, None)
        if used is None:
            return False
        used()
        return True

    def is_token(self, given: str) -> bool:
        """True for the token; compared in constant time."""
        return hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode("utf-8", "replace"))

    def has_cookie(self, header: str) -> bool:
        """True for a request whose ``Cookie`` stands for the token."""
        try:
            found = SimpleCookie(header).get(self._cookie)
        except CookieError:
            return False
        return found is not None and hmac.compare_digest(found.value.encode(), self._value.encode())

    def set_cookie(self) -> str:
        """The ``Set-Cookie`` that stands for the token: not for scripts, and not for requests of other sites."""
        return f"{self._cookie}={self._value}; HttpOnly; Path=/; SameSite=strict"
