"""This computer's own address: servers bound to it need no token; and recognition of requests from other web pages."""

from __future__ import annotations

import ipaddress
from urllib.parse import urlsplit

LOOPBACK = "127.0.0.1"
"""The address servers are bound to unless another one is asked for."""


def is_loopback(address: str) -> bool:
    """True for an address, or the name "localhost", that reaches this computer only."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def own_request(host: str, origin: str | None, local: bool, any_port: bool = False) -> bool:
    """True for a request by a program or by the server's own page, false for one that another web page caused.

    A page elsewhere that makes its visitor's browser ask this computer states its origin; one that has given its own
    name this computer's address (DNS rebinding) asks for that name as the host.

    Args:
        host: The request's ``Host``.
        origin: Its ``Origin``, which browsers add; None without.
        local: The server is bound to this computer's own address, so that only that may be asked for.
        any_port: Pages that another port of the same computer serves count as own, for a server without pages.
    """
    try:
        named, page = urlsplit(f"//{host}").hostname or "", urlsplit(origin or "")
        if local and not is_loopback(named):
            return False
        if origin is None or (any_port and local and is_loopback(page.hostname or "")):
            return True
        return bool(page.netloc) and (page.hostname == named if any_port else page.netloc == host)
    except ValueError:  # no host at all
        return False
