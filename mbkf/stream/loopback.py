"""This computer's own address: servers bound to it need no token."""

from __future__ import annotations

import ipaddress

LOOPBACK = "127.0.0.1"
"""The address servers are bound to unless another one is asked for."""


def is_loopback(address: str) -> bool:
    """Whether an address, or the name "localhost", reaches this computer only."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"
