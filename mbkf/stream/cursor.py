"""A place in a packet: every length is checked against the packet's end before anything is read or allocated."""

from __future__ import annotations

import struct
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import InvalidPacket

_COUNT = struct.Struct("<I")


class PacketCursor:
    """Reads a packet's payload from front to back, little endian.

    Attributes:
        protocol: Name of the protocol, for messages.
        data: The packet.
        at: Where the next field begins, bytes.
        end: Where the payload ends, bytes.
    """

    __slots__ = ("at", "data", "end")

    protocol: ClassVar[str]

    def __init__(self, data: bytes, at: int, end: int) -> None:
        """A cursor over ``data[at:end]``; ``end`` is not beyond the packet."""
        self.data, self.at, self.end = data, at, end

    def take(self, size: int) -> int:
        """Begin of the next so many bytes, which the cursor leaves behind.

        Raises:
            InvalidPacket: The packet ends before them.
        """
        at = self.at
        if size > self.end - at:
            raise InvalidPacket(f"{self.protocol}: {size} bytes are wanted where {self.end - at} are left")
        self.at = at + size
        return at

    def integer(self) -> int:
        """An unsigned integer of four bytes."""
        at = self.at
        if self.end - at < 4:
            self.take(4)
        self.at = at + 4
        count: int = _COUNT.unpack_from(self.data, at)[0]  # not through take: this is called most
        return count

    def count(self, least: int) -> int:
        """Number of things that follow, of which each takes at least so many bytes.

        Raises:
            InvalidPacket: So many do not fit.
        """
        count = self.integer()
        if count * least > self.end - self.at:
            raise InvalidPacket(f"{self.protocol}: {count} things cannot stand in {self.end - self.at} bytes")
        return count

    def fields(self, layout: struct.Struct) -> tuple:
        """The next fields of a fixed layout."""
        return layout.unpack_from(self.data, self.take(layout.size))

    def rows(self, layout: np.dtype, count: int) -> NDArray:
        """(count,) next elements of a fixed layout, a view of the packet."""
        return np.frombuffer(self.data, layout, count, self.take(count * layout.itemsize))
