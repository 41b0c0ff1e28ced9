"""Structure of a C3D file's parameter section: sound records are read, damaged ones are named.

Each record is: length of the name, group number, name, distance to the next record, then for a parameter its
type (−1 text, 1 byte, 2 integer, 4 float), its dimensions and its data. A damaged record costs only itself, and one
that points beyond the section is its last. Source: The C3D File Format, section on parameters (c3d.org).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

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


@dataclass(frozen=True)
class ParameterSection:
    """The sound records of a section, and the faults of the others.

    Attributes:
        groups: Names of the groups in capitals by their numbers, positive.
        records: The parameters in the file's order; each belongs to one of the groups.
        faults: One text for each damaged record.
        lost: Group, "" where there is none of that number, and name of each parameter that was left out.
        ended: False where the walk stopped at a damaged record, so that later ones are unknown.
        length: Bytes up to the end of its last record.
    """

    groups: Mapping[int, str] = field(default_factory=dict)
    records: tuple[ParameterRecord, ...] = ()
    faults: tuple[str, ...] = ()
    lost: tuple[tuple[str, str], ...] = ()
    ended: bool = True
    length: int = 0

    def states(self, group: str, name: str) -> bool:
        """True where a sound record states a parameter."""
        return bool(self.found(group, name))

    def found(self, group: str, name: str) -> list[ParameterRecord]:
        """The parameters of a name, several where groups share theirs; the last one holds.

        Args:
            group: Name of the group in capitals.
            name: Name of the parameter in capitals.
        """
        return [one for one in self.records if one.name == name and self.groups[one.group] == group]

    def integer(self, group: str, name: str, order: str) -> int | None:
        """First value of an integer parameter, without a sign; None where it is missing or of another type.

        Args:
            group: Name of the group in capitals.
            name: Name of the parameter in capitals.
            order: Byte order, "<" or ">".
        """
        found = self.found(group, name)
        if not found or found[-1].kind != 2 or len(found[-1].data) < 2:
            return None
        return int(struct.unpack_from(f"{order}H", found[-1].data)[0])

    def may_lack(self, group: str, names: Sequence[str]) -> bool:
        """True where damage may have taken one of the parameters of a group."""
        lost = [
            name for where, name in self.lost if where == group or not (where or self.states(group, name))
        ]
        if not set(lost).isdisjoint(names):
            return True
        cut = bool(self.faults) and (not self.ended or group not in self.groups.values())
        return cut and not all(self.states(group, name) for name in names)


class _DamagedRecord(ValueError):
    """A record contradicts itself; the text says how."""


def walk_parameters(section: bytes, order: str) -> ParameterSection:
    """The parameters of a section; after a damaged record, none replaces one that came before it.

    Args:
        section: The bytes from the section's first record on, to the end of the section.
        order: Byte order, "<" or ">".
    """
    groups: dict[int, str] = {}
    found: dict[tuple[int, str], ParameterRecord] = {}
    lost: list[tuple[int, str]] = []
    faults: list[str] = []
    walk = _Walk(section, order, faults)
    for number, name, body in walk:
        if number < 0:
            if groups.setdefault(-number, name) != name:
                faults.append(f"group {name} has the number of group {groups[-number]}")
            continue
        try:
            record = _parameter(number, name, body)
        except _DamagedRecord as error:
            faults.append(str(error))
            lost.append((number, name))
            continue
        if walk.at_last and _followed(body, record):
            faults.append(f"bytes after the record {name}, which is stated to be the last, are not read")
            walk.ended = False
        if not (faults and (number, name) in found):
            found[number, name] = record
    for number, name in [key for key in found if key[0] not in groups]:
        faults.append(f"parameter {name} belongs to no group")
        lost.append((number, name))
        del found[number, name]
    named = tuple((groups.get(number, ""), name) for number, name in lost)
    return ParameterSection(groups, tuple(found.values()), tuple(faults), named, walk.ended, walk.length)


class _Walk:
    """Group number (negative for a group itself), name and body of each record with a name.

    Attributes:
        ended: False once the walk has stopped at a damaged record.
        at_last: True at a record that is stated to be the last.
        length: Bytes up to the end of the last record.
    """

    def __init__(self, section: bytes, order: str, faults: list[str]) -> None:
        self._section, self._order, self._faults = section, order, faults
        self.ended, self.at_last, self.length = True, False, 0

    def __iter__(self) -> Iterator[tuple[int, str, bytes]]:
        section, at = self._section, 0
        while at + 2 <= len(section):  # ends: each record is at least 3 bytes long
            length, number = struct.unpack_from("bb", section, at)
            pointer = at + 2 + abs(length)
            if length == 0 or number == 0:
                return
            if pointer + 2 > len(section):
                self._stop(f"the record at byte {at} reaches beyond the section")
                return
            name = _name(section[at + 2 : pointer])
            if name is None:
                self._faults.append(f"the name at byte {at} is not text")
            (step,) = struct.unpack_from(f"{self._order}H", section, pointer)
            self.at_last = not step
            own = pointer + 2 + _own_length(section[pointer + 2 :], number)
            following = self._following(pointer, step, own, name or f"at byte {at}")
            self.length = following or min(own, len(section))
            if name is not None:
                yield number, name, section[pointer + 2 : following]
            if following is None:
                return
            at = following

    def _following(self, pointer: int, step: int, own: int, name: str) -> int | None:
        """Byte of the next record: as the record states or, where that is impossible, after its own data."""
        if not step:
            return None
        following = pointer + step
        within = following <= len(self._section)
        led = self._begins(following) or (self._ends(following) and following >= own)
        if step > 1 and within and (led or not self._begins(own)):
            return following
        fault = f"the record {name} points {'at no record' if within else 'beyond the section'}"
        if self._begins(own):
            self._faults.append(f"{fault}; its own length leads to the next")
            return own
        self._stop(fault)
        return None

    def _begins(self, at: int) -> bool:
        """True for a byte at which a record begins whose name, distance, type and dimensions are possible."""
        left = self._section[at:]
        length, number = struct.unpack_from("bb", left) if len(left) > 1 else (0, 0)
        body = 4 + abs(length)
        if not (length and number) or body > len(left) or _name(left[2 : body - 2]) is None:
            return False
        (step,) = struct.unpack_from(f"{self._order}H", left, body - 2)
        if step == 1 or body - 2 + step > len(left):
            return False
        if number < 0:
            return True
        kind, count = struct.unpack_from("bB", left, body) if body + 2 <= len(left) else (0, 0)
        return kind in _TYPES and count <= _MOST_DIMENSIONS

    def _ends(self, at: int) -> bool:
        """True for a byte at which the section is over."""
        left = self._section[at : at + 2]
        return at <= len(self._section) and not (len(left) == 2 and all(left))

    def _stop(self, fault: str) -> None:
        self._faults.append(fault)
        self.ended = False


def _own_length(body: bytes, number: int) -> int:
    """Length of a body by its type, dimensions and description; that of a group (negative number) has only the last."""
    data = 0
    if number > 0:
        kind, count = struct.unpack_from("bB", body) if len(body) > 1 else (0, 0)
        data = 2 + count + _TYPES.get(kind, 0) * math.prod(body[2 : 2 + count])
    return data + 1 + (body[data] if data < len(body) else 0)


def _followed(body: bytes, record: ParameterRecord) -> bool:
    """True where more than zeros stands after the data and the description of a record with such a body."""
    after = body[2 + len(record.dimensions) + len(record.data) :]
    return any(after[1 + after[0] :]) if after else False


def _name(letters: bytes) -> str | None:
    """A name in capitals, without blanks and zeros at its end; None where it is not text."""
    name = letters.rstrip(b"\0 ").decode("latin-1")
    return name.strip().upper() if name.strip() and name.isprintable() else None


def _parameter(group: int, name: str, body: bytes) -> ParameterRecord:
    if len(body) < 2:
        raise _DamagedRecord(f"parameter {name} is empty")
    kind, count = struct.unpack_from("bB", body)
    if kind not in _TYPES or count > _MOST_DIMENSIONS or len(body) < 2 + count:
        raise _DamagedRecord(f"parameter {name} has no valid type or dimensions")
    dimensions = tuple(body[2 : 2 + count])
    size = _TYPES[kind] * math.prod(dimensions)
    data = body[2 + count : 2 + count + size]
    if len(data) < size:
        raise _DamagedRecord(f"parameter {name} is longer than its record")
    return ParameterRecord(group, name, kind, dimensions, data)
