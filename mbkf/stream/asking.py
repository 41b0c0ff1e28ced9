"""A question to every computer of the network, over UDP, and the answers that come in time."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from select import select
from typing import NamedTuple

from mbkf.stream.datagrams import LARGEST
from mbkf.stream.loopback import LOOPBACK, is_loopback

EVERYBODY = "255.255.255.255"
"""Every computer of the network of the card that sends."""

MOST_ANSWERS = 16
"""Answers that are taken, at most: a laboratory has a few servers, and each is asked for its contents afterwards."""


class Answer(NamedTuple):
    """An answer: address that it came from, address of this computer that it came to, and its bytes."""

    address: str
    local: str
    data: bytes


def asked(question: Callable[[int], bytes], port: int, local: str, wait_s: float) -> list[Answer]:
    """The answers of all servers that hear a question, each answer of a computer once.

    Args:
        question: Makes the question, from the port at which the answer is awaited.
        port: Port that servers listen at.
        local: An address of this computer whose network is asked beside those of its name.
        wait_s: How long answers are taken.
    """
    own, found = own_addresses(local), dict[tuple[str, bytes], Answer]()
    with ExitStack() as opened:
        sockets = {}
        for address in own:
            one = opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            with suppress(OSError, OverflowError):  # an address that is gone, or a network that is down
                one.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
                one.bind((address, 0))
                one.setblocking(False)
                to = LOOPBACK if is_loopback(address) else EVERYBODY
                one.sendto(question(int(one.getsockname()[1])), (to, port))
                sockets[one] = address
        until = time.monotonic() + wait_s
        while sockets and len(found) < MOST_ANSWERS and (left_s := until - time.monotonic()) > 0.0:
            for one in select(list(sockets), [], [], left_s)[0]:
                with suppress(OSError):  # nobody listens there
                    data, (sender, *_) = one.recvfrom(LARGEST)
                    computer = LOOPBACK if sender in own else sender
                    found.setdefault((computer, data), Answer(computer, sockets[one], data))
    return list(found.values())


def own_addresses(local: str) -> list[str]:
    """Addresses of this computer: its own network, those of its name, and the given one (0.0.0.0 for no other)."""
    found = {LOOPBACK}
    with suppress(OSError, UnicodeError):  # many computers cannot resolve their own name
        found |= {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
    if local != "0.0.0.0":
        with suppress(OSError, UnicodeError):
            found.add(socket.gethostbyname(local))
    return sorted(found)
