"""A place in a NatNet packet: texts and parts of its protocol."""

from __future__ import annotations

import struct
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import InvalidPacket
from mbkf.stream.cursor import PacketCursor

_HEADER = struct.Struct("<2H")
_POINT = np.dtype(("<f4", (3,)))


class Cursor(PacketCursor):
    """Reads a NatNet packet's payload from front to back."""

    __slots__ = ()

    protocol: ClassVar[str] = "NatNet"

    def points(self, count: int) -> NDArray[np.float32]:
        """(count, 3) next points, single precision, a view of the packet."""
        return self.rows(_POINT, count)

    def text(self) -> str:
        """Text up to its closing nought; bytes that are not UTF-8 are replaced.

        Raises:
            InvalidPacket: It is not closed.
        """
        close = self.data.find(b"\0", self.at, self.end)
        if close < 0:
            raise InvalidPacket("NatNet: a text does not end")
        text = self.data[self.at : close].decode("utf-8", "replace")
        self.at = close + 1
        return text

    def skip_texts(self, count: int) -> None:
        """Leaves so many texts behind."""
        for _ in range(count):
            self.text()

    def part(self) -> int:
        """End of a part whose size is sent in front of it, as protocol 4.1 and later do.

        Raises:
            InvalidPacket: It reaches beyond the packet.
        """
        size = self.integer()
        if size > self.end - self.at:
            raise InvalidPacket(f"NatNet: a part of {size} bytes cannot stand in {self.end - self.at}")
        return self.at + size

    def sized_count(self, least: int) -> tuple[int, int]:
        """Number of things in a part, of which each takes at least so many bytes, and the part's end.

        Raises:
            InvalidPacket: So many do not fit, or the part reaches beyond the packet.
        """
        count, end = self.integer(), self.part()
        if count * least > end - self.at:
            raise InvalidPacket(f"{self.protocol}: {count} things cannot stand in {end - self.at} bytes")
        return count, end

    def leave(self, end: int) -> None:
        """Goes to the end of a part.

        Raises:
            InvalidPacket: More than the part was read.
        """
        if self.at > end:
            raise InvalidPacket("NatNet: a part is shorter than its contents")
        self.at = end


def opened(packet: bytes) -> tuple[int, Cursor]:
    """Number of a message, and a cursor at its payload; bytes after the stated length are left out.

    Raises:
        InvalidPacket: The packet is shorter than it states, or has no header.
    """
    if len(packet) < _HEADER.size:
        raise InvalidPacket(f"NatNet: a packet of {len(packet)} bytes")
    number, size = _HEADER.unpack_from(packet)
    if size > len(packet) - _HEADER.size:
        raise InvalidPacket(f"NatNet: a packet states {size} bytes and brings {len(packet) - _HEADER.size}")
    return number, Cursor(packet, _HEADER.size, _HEADER.size + size)
