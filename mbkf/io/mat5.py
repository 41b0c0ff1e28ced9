"""MATLAB's files of version 5 to 7, decoded strictly: real arrays of numbers, and structs of them.

Every size that a file states is held against the bytes that are there before anything is made of it, and packed
variables are unpacked no further than the size they begin with. Texts, cells, sparse and complex arrays, objects and
functions are passed over; nothing in a file is ever run.

Source: MATLAB MAT-File Format (The MathWorks), sections Level 5 MAT-File Format and Level 5 MAT-Array Data Element
Formats.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np

from mbkf.conventions import Array
from mbkf.io.files_read import read_bytes

Variable: TypeAlias = "Array | Mapping[str, Array]"
"""An array, or a struct's arrays by field."""

MOST_BYTES = 1 << 29
"""Bound of all unpacked variables of a file; a day of a sensor at 100 Hz."""

MOST_DIMENSIONS, MOST_FIELD_NAME = 8, 256

_HEADER, _VERSION, _VERSION_HDF5 = 128, 0x0100, 0x0200
_NUMBERS = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"
}  # fmt: skip
_INT8, _INT32, _UINT32, _MATRIX, _PACKED = 1, 5, 6, 14, 15
_STRUCT, _NUMERIC, _COMPLEX = 2, range(6, 16), 0x08


class _Element(NamedTuple):
    """A data element: its type and its bytes."""

    kind: int
    body: memoryview


def read_mat5(path: Path) -> dict[str, Variable]:
    """The variables of a file that are real arrays or structs of such; arrays without their dimensions of one.

    Raises:
        OSError: The file cannot be read.
        ValueError: It is another kind of file, or a size in it does not fit.
    """
    content = read_bytes(path)
    if len(content) < _HEADER or content[126:128] not in (b"IM", b"MI"):
        raise ValueError("not a MATLAB 5 file")
    order = "<" if content[126:128] == b"IM" else ">"
    (version,) = struct.unpack(f"{order}H", content[124:126])
    if version == _VERSION_HDF5:
        raise ValueError("it is of version 7.3; save it with -v7")
    if version != _VERSION:
        raise ValueError(f"version {version:#x} is not known")
    found: dict[str, Variable] = {}
    left = MOST_BYTES
    for element in _elements(memoryview(content)[_HEADER:], order):
        one = element
        if one.kind == _PACKED:
            unpacked = _unpacked(one.body, order, left)
            left -= len(unpacked)
            (one,) = _elements(memoryview(unpacked), order)
        if one.kind == _MATRIX:
            name, variable = _matrix(one.body, order, within=False)
            if variable is not None:
                found[name] = variable
    return found


def _elements(data: memoryview, order: str) -> Iterator[_Element]:
    """The data elements that follow each other, all of which end within the data."""
    at = 0
    while at < len(data):
        if at + 8 > len(data):
            raise ValueError("cut short within a tag")
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a small element holds its data in its tag
            kind, size = kind & 0xFFFF, kind >> 16
            if size > 4:
                raise ValueError(f"a small element of {size} bytes")
            start, end = at + 4, at + 8
        else:
            start = at + 8
            end = start + (size if kind == _PACKED else -(-size // 8) * 8)
        if start + size > len(data):
            raise ValueError(f"an element of {size} bytes where {len(data) - start} are left")
        yield _Element(kind, data[start : start + size])
        at = end


def _unpacked(body: memoryview, order: str, most: int) -> bytes:
    """A packed variable, no longer than the tag at its beginning says and than ``most`` bytes."""
    stream = zlib.decompressobj()
    try:
        tag = stream.decompress(body, 8)
        if len(tag) < 8:
            raise ValueError("a packed variable without a tag")
        kind, size = struct.unpack(f"{order}II", tag)
        if kind != _MATRIX or size + 8 > most:
            raise ValueError(f"a packed variable of type {kind} and {size} bytes")
        rest = stream.decompress(stream.unconsumed_tail, size + 1)
    except zlib.error as error:
        raise ValueError(f"a packed variable is damaged ({error})") from error
    if len(rest) != size or not stream.eof:
        raise ValueError("a packed variable is not as long as it says")
    return tag + rest


def _matrix(body: memoryview, order: str, within: bool) -> tuple[str, Variable | None]:
    """Name and contents of an array; None for kinds that are passed over, as structs ``within`` a struct are."""
    parts = _elements(body, order)
    flags = next(parts, None)
    if flags is None:
        return "", None  # an array without contents
    if flags.kind != _UINT32 or len(flags.body) != 8:
        raise ValueError("an array without flags")
    (word,) = struct.unpack_from(f"{order}I", flags.body)
    kind, is_complex = word & 0xFF, bool(word >> 8 & _COMPLEX)
    if kind != _STRUCT and kind not in _NUMERIC:
        return "", None
    shape = _shape(next(parts, None), order)
    name = _text(next(parts, None))
    if kind == _STRUCT:
        one = math.prod(shape) == 1 and not within
        return name, _fields(parts, order) if one else None
    values = next(parts, None)
    if values is None or values.kind not in _NUMBERS:
        raise ValueError(f"'{name}' holds no numbers")
    dtype = np.dtype(order + _NUMBERS[values.kind])
    if math.prod(shape) * dtype.itemsize != len(values.body):
        raise ValueError(f"'{name}' of size {' x '.join(map(str, shape))} has {len(values.body)} bytes")
    if is_complex:
        return name, None
    array = np.frombuffer(values.body, dtype).astype(np.float64)
    return name, np.squeeze(array.reshape(shape, order="F"))


def _shape(element: _Element | None, order: str) -> tuple[int, ...]:
    if element is None or element.kind != _INT32 or len(element.body) % 4:
        raise ValueError("an array without dimensions")
    shape = tuple(np.frombuffer(element.body, f"{order}i4").tolist())
    if not 2 <= len(shape) <= MOST_DIMENSIONS or min(shape) < 0:
        raise ValueError(f"an array with dimensions {shape[:MOST_DIMENSIONS]}")
    return shape


def _text(element: _Element | None) -> str:
    if element is None or element.kind != _INT8:
        raise ValueError("an array without a name")
    return bytes(element.body).decode("latin-1")


def _fields(parts: Iterator[_Element], order: str) -> dict[str, Array]:
    """The fields of a struct of one element that are arrays."""
    width = next(parts, None)
    if width is None or width.kind != _INT32 or len(width.body) != 4:
        raise ValueError("a struct without the length of its names")
    (length,) = struct.unpack(f"{order}i", width.body)
    names = _text(next(parts, None))
    if not 0 < length <= MOST_FIELD_NAME or len(names) % length:
        raise ValueError(f"a struct whose names have {length} letters")
    found: dict[str, Array] = {}
    for at in range(0, len(names), length):
        element = next(parts, None)
        if element is None or element.kind != _MATRIX:
            raise ValueError("a struct with fewer fields than names")
        _, value = _matrix(element.body, order, within=True)
        if isinstance(value, np.ndarray):
            found[names[at : at + length].partition("\0")[0]] = value
    return found
