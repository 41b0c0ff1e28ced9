"""Qualisys Track Managers that answer in the network.

Source: QTM Real-time Server Protocol Documentation 1.25 (Qualisys), section Auto discover.
"""

from __future__ import annotations

import struct
from contextlib import suppress

from mbkf.errors import MbkfError
from mbkf.stream.asking import Answer, asked
from mbkf.stream.found import FoundStream
from mbkf.stream.qualisys.client import BASE_PORT
from mbkf.stream.qualisys.packets import COMMAND, DISCOVER, HEADER, packet, text_of
from mbkf.stream.qualisys.source import QualisysSource

DISCOVER_PORT = BASE_PORT + 4
"""Port that QTM listens at for clients that look for it, whatever its base port is."""

LAST_PORT = 65535

_PORT = struct.Struct(">H")


def qualisys_streams(local: str, timeout_s: float, port: int = DISCOVER_PORT) -> list[FoundStream]:
    """The servers that answer, and what each streams.

    Args:
        local: An address of this computer whose network is asked, too.
        timeout_s: How long answers are taken.
        port: The port that is asked.
    """
    answers = asked(lambda own: packet(DISCOVER, _PORT.pack(own)), port, local, timeout_s)
    return [found for one in answers if (found := _found(one)) is not None]


def _found(answer: Answer) -> FoundStream | None:
    """The server that answered; None where the packet is not from QTM."""
    data = answer.data
    if len(data) < HEADER.size + _PORT.size or HEADER.unpack_from(data) != (len(data), COMMAND):
        return None
    name = text_of(data[HEADER.size : -_PORT.size])
    base: int = _PORT.unpack(data[-_PORT.size :])[0]
    if not 0 < base < LAST_PORT:  # clients connect to the port after it
        return None
    source, stream = QualisysSource(answer.address, base), None
    with suppress(MbkfError):  # it does not measure
        stream = source.connect(0.0)
    source.close()
    place = answer.address if base == BASE_PORT else f"{answer.address}:{base}"
    return FoundStream("qualisys", name, answer.address, place).described(stream)
