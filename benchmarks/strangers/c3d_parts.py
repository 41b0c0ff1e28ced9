"""Header, records and data of a C3D file as bytes that can be changed one by one; independent of the reader.

Source: The C3D File Format (c3d.org).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

BLOCK = 512
INTEL = 84


@dataclass
class Record:
    """A group (negative number) or a parameter.

    Attributes:
        number: Number of its group.
        name: Its name as it stands in the file.
        body: Type, dimensions, data and description of a parameter, or a group's description.
        step: Distance to the next record; None for the true one.
    """

    number: int
    name: bytes
    body: bytes
    step: int | None = None

    def encoded(self) -> bytes:
        """Its bytes."""
        step = len(self.body) + 2 if self.step is None else self.step
        return (
            struct.pack("bb", len(self.name), self.number) + self.name + struct.pack("<H", step) + self.body
        )


@dataclass
class C3dParts:
    """A C3D file with numbers of Intel's order.

    Attributes:
        header: Its first block.
        records: Groups and parameters.
        data: Points and analog samples.
        ending: Bytes after the last record.
        start: Block of the parameters, from 1.
        blocks: Stated number of their blocks; None for the true one.
        head: The first two bytes of the parameters.
    """

    header: bytearray
    records: list[Record]
    data: bytes
    ending: bytes = b"\0\0"
    start: int = 2
    blocks: int | None = None
    head: bytes = field(default=b"\x01\x50")

    @classmethod
    def of(cls, content: bytes) -> C3dParts:
        """The parts of a sound file's bytes."""
        header = bytearray(content[:BLOCK])
        at = (header[0] - 1) * BLOCK + 4
        records = []
        while content[at] and content[at + 1]:  # ends: the file is sound, so that its last record is empty
            length, number = struct.unpack_from("bb", content, at)
            name = content[at + 2 : at + 2 + abs(length)]
            at += 2 + abs(length)
            (step,) = struct.unpack_from("<H", content, at)
            records.append(Record(number, name, content[at + 2 : at + step]))
            if not step:
                break
            at += step
        (data_block,) = struct.unpack_from("<H", header, 16)
        return cls(header, records, content[(data_block - 1) * BLOCK :])

    def encoded(self) -> bytes:
        """The file's bytes; header and POINT:DATA_START name the block of its data."""
        if self.has("POINT", "DATA_START"):
            self.put("POINT", "DATA_START", integers([0]))
        length = 4 + sum(len(one.encoded()) for one in self.records) + len(self.ending)
        blocks = -(-length // BLOCK)
        first = self.start + blocks
        self.word(8, first)
        if self.has("POINT", "DATA_START"):
            self.put("POINT", "DATA_START", integers([first]))
        stated = blocks if self.blocks is None else self.blocks
        section = self.head + bytes([stated, INTEL]) + b"".join(one.encoded() for one in self.records)
        section = (section + self.ending).ljust(blocks * BLOCK, b"\0")
        self.header[0] = self.start
        return bytes(self.header).ljust((self.start - 1) * BLOCK, b"\0") + section + self.data

    def word(self, index: int, value: int | None = None) -> int:
        """A 16-bit word of the header, changed where a value is given.

        Args:
            index: Its index from 0.
            value: Its new value.
        """
        if value is not None:
            struct.pack_into("<H", self.header, 2 * index, value % 65536)
        return int(struct.unpack_from("<H", self.header, 2 * index)[0])

    def group(self, name: str) -> int:
        """Number of a group."""
        return next(-one.number for one in self.records if one.number < 0 and one.name == name.encode())

    def has(self, group: str, name: str) -> bool:
        """True where the file states a parameter."""
        groups = [-one.number for one in self.records if one.number < 0 and one.name == group.encode()]
        return any(one.number in groups and one.name == name.encode() for one in self.records)

    def record(self, group: str, name: str) -> Record:
        """A parameter."""
        number = self.group(group)
        return next(one for one in self.records if one.number == number and one.name == name.encode())

    def put(self, group: str, name: str, body: bytes) -> None:
        """Gives a parameter another body, or adds it.

        Args:
            group: Name of its group.
            name: Its name.
            body: Type, dimensions, data and description.
        """
        if self.has(group, name):
            self.record(group, name).body = body
        else:
            self.records.append(Record(self.group(group), name.encode(), body))

    def drop(self, keep: Callable[[Record], bool]) -> None:
        """Keeps some of the records."""
        self.records = [one for one in self.records if keep(one)]

    def without(self, group: str, name: str) -> None:
        """Leaves out a parameter."""
        left = self.record(group, name)
        self.drop(lambda one: one is not left)


def integers(values: object) -> bytes:
    """Body of a parameter of 16-bit integers."""
    return _body(2, np.asarray(values).astype("<i4").astype("<i2"))


def floats(values: object) -> bytes:
    """Body of a parameter of floats."""
    return _body(4, np.asarray(values).astype("<f4"))


def words(texts: list[bytes]) -> bytes:
    """Body of a parameter of texts."""
    length = max(len(text) for text in texts)
    return (
        struct.pack("bBBB", -1, 2, length, len(texts))
        + b"".join(text.ljust(length) for text in texts)
        + b"\0"
    )


def _body(kind: int, values: np.ndarray) -> bytes:
    shape = struct.pack(f"bB{values.ndim}B", kind, values.ndim, *values.shape)
    return shape + values.tobytes(order="F") + b"\0"
