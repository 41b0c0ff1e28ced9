"""Who may ask a server of this computer: its own programs and pages without, others with a token.

A server bound to this computer's own address needs no token, but another web page must not reach it by the visitor's
browser, neither directly (its requests carry an Origin that is not the server's) nor by a name of its own that it lets
point here (its requests carry that name as Host).
"""

from __future__ import annotations

import hmac
import ipaddress
import re
from urllib.parse import urlsplit

LOOPBACK = "127.0.0.1"
"""The address servers are bound to unless another one is asked for."""

OWN_PAGES = re.compile(r"https?://(localhost|127\.0\.0\.1|\[::1\])(:\d+)?")
"""Origins of pages that this computer serves."""


def is_loopback(address: str) -> bool:
    """Whether an address, or the name "localhost", reaches this computer only."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def names_this_computer(host: str) -> bool:
    """Whether the Host of a request, port included, is this computer's own name for itself."""
    try:
        return is_loopback(urlsplit(f"//{host}").hostname or "")
    except ValueError:
        return False


def is_page_of(origin: str | None, host: str) -> bool:
    """Whether a request comes from a page of this very server, or from a program.

    Args:
        origin: Its Origin; None for a program.
        host: Its Host.
    """
    try:
        return origin is None or urlsplit(origin).netloc == host
    except ValueError:
        return False


def is_token(given: str, token: str) -> bool:
    """Whether a token is the right one, in a time that does not tell how much of it is."""
    return hmac.compare_digest(given.encode(), token.encode())
