"""A sender of JSON lines that is heard at a port of this computer: a sender announces itself by sending."""

from __future__ import annotations

from contextlib import closing, suppress

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.side_by_side import at_own_addresses
from mbkf.stream.udp.messages import DEFAULT_PORT
from mbkf.stream.udp.source import UdpSource


def udp_streams(local: str, timeout_s: float, port: int = DEFAULT_PORT) -> list[FoundStream]:
    """The senders that are heard first at this computer's addresses; nothing where another program listens there.

    Args:
        local: An address of this computer to listen at, beside those of its name.
        timeout_s: How long to listen.
        port: The port.
    """

    def listen(address: str) -> FoundStream | None:
        stream = sender = None
        with suppress(MbkfError), closing(UdpSource(port, address)) as source:
            stream, sender = source.connect(timeout_s), source.sender
        if stream is None or sender is None:
            return None
        place = "" if port == DEFAULT_PORT else str(port)
        return FoundStream("udp", stream.trial, sender, place, {"local": address}).described(stream)

    return at_own_addresses(listen, local)
