"""Camera computers with Motive that answer in the network.

Source: the NatNet SDK's description of its packets (NatNetTypes.h: sSender_Server).
"""

from __future__ import annotations

import struct
from contextlib import closing, suppress
from dataclasses import replace
from functools import partial

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream.asking import Answer, asked
from mbkf.stream.found import FoundStream
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.client import NatNetClient
from mbkf.stream.natnet.cursor import opened
from mbkf.stream.natnet.descriptions import Descriptions
from mbkf.stream.natnet.layout import own_sets
from mbkf.stream.natnet.server import read_version
from mbkf.stream.side_by_side import side_by_side

COMMAND_PORT = 1510
"""Motive's command port."""

DESCRIBED_S = 0.5
"""A server that answered describes its stream within this time."""

_SERVER = struct.Struct("<256s4B4B")
_CONNECTION = struct.Struct("<QHB4B")
"""Frequency of the clock, port of data, 1 for multicast, and the group."""


def natnet_streams(local: str, timeout_s: float, port: int = COMMAND_PORT) -> list[FoundStream]:
    """The servers that answer, and what each streams.

    Args:
        local: An address of this computer whose network is asked, too.
        timeout_s: How long answers are taken.
        port: The command port that is asked.
    """
    answers = asked(lambda _: packets.message(packets.CONNECT, b"Ping\0"), port, local, timeout_s)
    return side_by_side(partial(_found, port), answers)


def _found(port: int, answer: Answer) -> FoundStream | None:
    """The server that answered; None where the packet is of another kind or of a version that we do not read."""
    options = {"server": answer.address, "local": answer.local}
    if port != COMMAND_PORT:
        options["port"] = str(port)
    try:
        read_version(answer.data)
        number, cursor = opened(answer.data)
        name: bytes = cursor.fields(_SERVER)[0]
    except InvalidPacket:
        return None
    if number != packets.SERVER_INFO:
        return None
    with suppress(InvalidPacket):  # a short answer does not state its connection
        _, _, multicast, *group = cursor.fields(_CONNECTION)
        if multicast == 1:
            options["multicast"] = ".".join(map(str, group))
    found = FoundStream(
        "natnet", name.split(b"\0")[0].decode("utf-8", "replace"), answer.address, "", options
    )
    described = _described(answer, port)
    if described is None:
        return found
    markers = sum(len(one.markers) for one in own_sets(described))
    return replace(found, markers=markers, plates=len(described.plates))


def _described(answer: Answer, port: int) -> Descriptions | None:
    """The contents of a server's stream; None where it does not state them in time."""
    try:
        client = NatNetClient(answer.address, answer.local, port, None)
    except InvalidInput:  # the network went down
        return None
    with closing(client):
        client.described.wait(DESCRIBED_S)
        return client.descriptions
