"""Qualisys Track Managers that answer in the network, or at a given computer.

Source: QTM Real-time Server Protocol Documentation 1.25 (Qualisys), section Auto discover.
"""

from __future__ import annotations

import struct
from contextlib import closing, suppress

from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.asking import Answer, asked
from mbkf.stream.found import FoundStream
from mbkf.stream.qualisys.client import BASE_PORT, QtmClient
from mbkf.stream.qualisys.packets import COMMAND, DISCOVER, HEADER, packet, text_of
from mbkf.stream.qualisys.parameters import read_parameters
from mbkf.stream.side_by_side import side_by_side
from mbkf.stream.source import StreamDescription

DISCOVER_PORT = BASE_PORT + 4
"""Port that QTM listens at for clients that look for it, whatever its base port is."""

LAST_PORT = 65535

DESCRIBED_S = 1.5
"""A server that answered describes its stream within this time."""

_PORT = struct.Struct(">H")


def qualisys_streams(local: str, timeout_s: float, port: int = DISCOVER_PORT) -> list[FoundStream]:
    """The servers that answer, and what each streams.

    Args:
        local: An address of this computer whose network is asked, too.
        timeout_s: How long answers are taken.
        port: The port that is asked.
    """
    answers = asked(lambda own: packet(DISCOVER, _PORT.pack(own)), port, local, timeout_s)
    return side_by_side(_found, answers)


def qualisys_at(host: str, base: int) -> list[FoundStream]:
    """The server of a computer and what it streams; nothing where another one answers or none does.

    Args:
        host: The computer.
        base: Its base port.
    """
    try:
        return [_server("QTM", host, base).described(_described(host, base))]
    except (OSError, InvalidInput):
        return []


def _found(answer: Answer) -> FoundStream | None:
    """The server that answered; None where the packet is not from QTM."""
    data = answer.data
    if len(data) < HEADER.size + _PORT.size or HEADER.unpack_from(data) != (len(data), COMMAND):
        return None
    base: int = _PORT.unpack(data[-_PORT.size :])[0]
    if not 0 < base < LAST_PORT:  # clients connect to the port after it
        return None
    found = _server(text_of(data[HEADER.size : -_PORT.size]), answer.address, base)
    with suppress(OSError, InvalidInput):
        return found.described(_described(answer.address, base))
    return found


def _server(name: str, host: str, base: int) -> FoundStream:
    return FoundStream("qualisys", name, host, host if base == BASE_PORT else f"{host}:{base}")


def _described(host: str, base: int) -> StreamDescription | None:
    """A server's stream; None where it does not measure.

    Raises:
        OSError: The server is not there, or does not answer in time.
        InvalidInput: It is not QTM.
    """
    with closing(QtmClient(host, base, greeting_s=DESCRIBED_S)) as client, suppress(MbkfError):
        return read_parameters(client.parameters, None).stream
    return None
