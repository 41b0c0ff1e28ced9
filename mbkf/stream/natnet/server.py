"""A NatNet server's answer to a client that connects: the protocol it speaks."""

from __future__ import annotations

import struct

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet.cursor import opened

Version = tuple[int, int]
"""Major and minor number of a protocol."""

OLDEST: Version = (3, 0)
"""The oldest protocol that is read: force plates are described from it on, and Motive 2 and later speak it."""

NEWER: Version = (5, 0)
"""From this protocol on nothing is known about the layout."""

_ANSWER = struct.Struct("<256s4B4B")


def read_version(packet: bytes) -> Version:
    """The protocol of a server's stream, by its answer.

    Raises:
        InvalidPacket: It is another message, or the protocol is not one of 3.0 to 4.x.
    """
    fields = opened(packet)[1].fields(_ANSWER)
    version = (int(fields[5]), int(fields[6]))
    if not OLDEST <= version < NEWER:
        raise InvalidPacket(
            f"NatNet: a server answers with protocol {version[0]}.{version[1]}; 3.0 to 4.x are read"
        )
    return version
