"""A sender of JSON lines that is heard at a port of this computer: a sender announces itself by sending."""

from __future__ import annotations

from contextlib import closing, suppress

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.udp.messages import DEFAULT_PORT
from mbkf.stream.udp.source import UdpSource


def udp_streams(local: str, timeout_s: float, port: int = DEFAULT_PORT) -> list[FoundStream]:
    """The sender that is heard first; nothing where none is, or another program listens at the port.

    Args:
        local: The address of this computer to listen at.
        timeout_s: How long to listen.
        port: The port.
    """
    stream = None
    with suppress(MbkfError), closing(UdpSource(port, local)) as source:
        stream = source.connect(timeout_s)
        sender = source.sender
    if stream is None or sender is None:
        return []
    place = "" if port == DEFAULT_PORT else str(port)
    return [FoundStream("udp", stream.trial, sender, place, {"local": local}).described(stream)]
