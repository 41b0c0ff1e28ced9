"""Structure of a C3D file's parameter section, walked before a library trusts it.

Each record is: length of the name, group number, name, distance to the next record, then for a parameter its
type (−1 text, 1 byte, 2 integer, 4 float), its dimensions and its data. A damaged record sends a reader outside
the file. Source: The C3D File Format, section on parameters (c3d.org).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass

_TYPES = {-1: 1, 1: 1, 2: 2, 4: 4}
_MOST_DIMENSIONS = 7


@dataclass(frozen=True)
class ParameterRecord:
    """One parameter of the file.

    Attributes:
        group: Number of its group, positive.
        name: Its name in capitals.
        kind: −1 text, 1 byte, 2 integer, 4 float.
        dimensions: Its dimensions; empty for a single value.
        data: Its bytes.
    """

    group: int
    name: str
    kind: int
    dimensions: tuple[int, ...]
    data: bytes


class DamagedParameters(ValueError):
    """The parameter section does not hold together; the text says where."""


def walk_parameters(section: bytes, order: str) -> tuple[dict[int, str], list[ParameterRecord]]:
    """Group number → name in capitals, and the parameters of a section in the file's order.

    Args:
        section: The bytes from the section's first record on, to the end of the section.
        order: Byte order, "<" or ">".

    Raises:
        DamagedParameters: A record reaches beyond the section or contradicts itself.
    """
    groups: dict[int, str] = {}
    parameters = []
    for number, name, body in _records(section, order):
        if number < 0:
            groups[-number] = name
        else:
            parameters.append(_parameter(number, name, body))
    unknown = [parameter.name for parameter in parameters if parameter.group not in groups]
    if unknown:
        raise DamagedParameters(f"parameter {unknown[0]} belongs to no group")
    return groups, parameters


def first_integer(parameter: ParameterRecord, order: str) -> int | None:
    """First value of an integer parameter, read as unsigned; None for another kind."""
    if parameter.kind != 2 or len(parameter.data) < 2:
        return None
    return int(struct.unpack_from(f"{order}H", parameter.data)[0])


def _records(section: bytes, order: str) -> Iterator[tuple[int, str, bytes]]:
    """Group number (negative for a group itself), name and body of each record."""
    at = 0
    while at + 2 <= len(section):
        length, number = struct.unpack_from("bb", section, at)
        length = abs(length)
        if length == 0 or number == 0:
            return
        pointer = at + 2 + length
        if pointer + 2 > len(section):
            raise DamagedParameters(f"the record at byte {at} reaches beyond the section")
        name = section[at + 2 : pointer]
        if not all(32 <= letter < 127 for letter in name):
            raise DamagedParameters(f"the name at byte {at} is not text")
        (step,) = struct.unpack_from(f"{order}H", section, pointer)
        following = pointer + step if step else len(section)
        if following > len(section) or (step and step < 3):
            raise DamagedParameters(f"the record '{name.decode()}' points beyond the section")
        yield number, name.decode().strip().upper(), section[pointer + 2 : following]
        if not step:
            return
        at = following


def _parameter(group: int, name: str, body: bytes) -> ParameterRecord:
    if len(body) < 2:
        raise DamagedParameters(f"parameter {name} is empty")
    kind, count = struct.unpack_from("bB", body)
    if kind not in _TYPES or count > _MOST_DIMENSIONS or len(body) < 2 + count:
        raise DamagedParameters(f"parameter {name} has no valid type or dimensions")
    dimensions = tuple(body[2 : 2 + count])
    size = _TYPES[kind] * math.prod(dimensions)
    data = body[2 + count : 2 + count + size]
    if len(data) < size:
        raise DamagedParameters(f"parameter {name} is longer than its record")
    return ParameterRecord(group, name, kind, dimensions, data)
