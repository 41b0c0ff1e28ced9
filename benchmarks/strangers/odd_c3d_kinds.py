"""Odd C3D files: one edit each of a sound public capture, with the right answer.

An edit changes the parts of a file and, where the fault lies in the file as a whole, returns its bytes. The right
answer is the sound capture, without what the edit takes away, or a refusal whose reason holds given words.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmarks.strangers.c3d_parts import C3dParts, Record, floats, integers, words

FLOATS = "judgement/walk7_120frames.c3d"
WHOLE = "c3d_encodings/Eb015pi.c3d"
EVENTS = "unipd_walk/Walking1.c3d"

_FRAMES, _POINTS, _NUMBERS, _PLATES = 120, 36, 684, 9
"""Frames, points, numbers per frame and plates of :data:`FLOATS`."""

Edit = Callable[[C3dParts], bytes | None]


@dataclass(frozen=True)
class OddC3d:
    """A kind of odd file.

    Attributes:
        name: The kind.
        base: The sound capture.
        edit: Makes it odd.
        says: Words of the remark that has to be there; empty where nothing is lost.
        refused: Words of the reason for which it is refused; empty where it is read.
        plates: False where the edit takes the plates' parameters away.
        named: False where it takes the points' names away.
        events: False where it takes the events' times away.
    """

    name: str
    base: str
    edit: Edit
    says: str = ""
    refused: str = ""
    plates: bool = True
    named: bool = True
    events: bool = True


def put(group: str, name: str, body: bytes) -> Edit:
    """Gives a parameter another body, or adds it.

    Args:
        group: Name of its group.
        name: Its name.
        body: Type, dimensions, data and description.
    """
    return lambda parts: parts.put(group, name, body)


def without(group: str, name: str) -> Edit:
    """Leaves out a parameter."""
    return lambda parts: parts.without(group, name)


def inserted(record: Record) -> Edit:
    """Puts a record among the first ones."""
    return lambda parts: parts.records.insert(3, record)


def word(index: int, value: int) -> Edit:
    """Changes a word of the header."""

    def edit(parts: C3dParts) -> None:
        parts.word(index, value)

    return edit


def number(at: int, value: float) -> Edit:
    """Changes a float of the header by its byte."""
    return lambda parts: struct.pack_into("<f", parts.header, at, value)


def byte(at: int, value: int) -> Edit:
    """Changes a byte of the whole file."""

    def edit(parts: C3dParts) -> bytes:
        content = bytearray(parts.encoded())
        content[at] = value
        return bytes(content)

    return edit


def both(first: Edit, second: Edit) -> Edit:
    """Two edits."""

    def edit(parts: C3dParts) -> bytes | None:
        first(parts)
        return second(parts)

    return edit


def ending(added: bytes) -> Edit:
    """Bytes after the file."""
    return lambda parts: parts.encoded() + added


def cut(frames: int) -> Edit:
    """The file with so many of its frames."""

    def edit(parts: C3dParts) -> bytes:
        parts.data = parts.data[: frames * _NUMBERS * 4]
        return parts.encoded()

    return edit


def _start(block: int) -> Edit:
    def edit(parts: C3dParts) -> None:
        parts.start = block

    return edit


def _blocks(count: int) -> Edit:
    def edit(parts: C3dParts) -> None:
        parts.blocks = count

    return edit


def _unended(parts: C3dParts) -> None:
    parts.ending = b""


def _last_of_distance_zero(parts: C3dParts) -> None:
    parts.records[-1].step = 0


def _small(parts: C3dParts) -> None:
    for record in parts.records:
        record.name = record.name.lower()


def _groups_last(parts: C3dParts) -> None:
    parts.records.sort(key=lambda one: one.number < 0)


def _group_twice(parts: C3dParts) -> None:
    number = max(-one.number for one in parts.records) + 1
    moved = [parts.record("POINT", name) for name in ("RATE", "UNITS")]
    parts.records.append(Record(-number, b"POINT", b"\0"))
    for one in moved:
        one.number = number


def _groupless(parts: C3dParts) -> None:
    number = -parts.group("POINT")
    parts.drop(lambda one: one.number != number)


def _renamed_origin(parts: C3dParts) -> None:
    parts.record("FORCE_PLATFORM", "ORIGIN").name = b"ORIGINS"


def _labels_in_three(parts: C3dParts) -> None:
    names = _names(parts)
    for number, (first, last) in enumerate(pairwise((0, 12, 24, _POINTS)), start=1):
        parts.put("POINT", "LABELS" + (str(number) if number > 1 else ""), words(names[first:last]))


def _more_labels(parts: C3dParts) -> None:
    parts.put("POINT", "LABELS", words([*_names(parts), b"GHOST"]))


def _names(parts: C3dParts) -> list[bytes]:
    body = parts.record("POINT", "LABELS").body
    length, count = body[2:4]
    return [body[4 + k * length : 4 + (k + 1) * length] for k in range(count)]


def _header_events(parts: C3dParts) -> None:
    struct.pack_into("<HH", parts.header, 298, 12345, 2)
    struct.pack_into("<2f", parts.header, 304, 0.5, float("nan"))
    parts.header[396:404] = b"RFS LFS "


_CHANNELS = integers(np.arange(1, 6 * _PLATES + 1))
_NOT_USED = "not used: POINT:RATE"
_FEW = floats(np.ones(10))
_TIMELESS = floats(np.full((2, 3), np.nan))

STRUCTURE = (
    OddC3d("parameter of a missing group", FLOATS, inserted(Record(77, b"LOST", floats([1.0]))), "to no group"),
    OddC3d("record beyond the section", FLOATS, inserted(Record(1, b"FAR", floats([1.0]), 30000)), "beyond the"),
    OddC3d("record that points into itself", FLOATS, inserted(Record(1, b"NEAR", floats([1.0]), 1)), "at no record"),
    OddC3d("record without a body", FLOATS, inserted(Record(1, b"EMPTY", b"")), "EMPTY is empty"),
    OddC3d("unreadable parameter name", FLOATS, inserted(Record(1, b"\1\2\xff\x9a", floats([1.0]))), "is not text"),
    OddC3d("unreadable group name", FLOATS, inserted(Record(-60, b"\7\2\x9f", b"\0")), "is not text"),
    OddC3d("parameter of an unknown type", FLOATS, inserted(Record(1, b"ODD", b"\x07\x01\x02\0\0\0")), "no valid type"),
    OddC3d("too many dimensions", FLOATS, inserted(Record(1, b"DIMS", b"\x04\x1e" + bytes(20))), "no valid type"),
    OddC3d("data longer than its record", FLOATS, inserted(Record(1, b"LONG", b"\x04\x01\xc8" + bytes(8))), "longer"),
    OddC3d("no end marker", FLOATS, _unended),
    OddC3d("last record of distance zero", FLOATS, _last_of_distance_zero),
    OddC3d("parameters at block 4", FLOATS, _start(4)),
    OddC3d("section of 0 blocks", FLOATS, _blocks(0)),
    OddC3d("section of 1 block", FLOATS, _blocks(1)),
    OddC3d("section of 255 blocks", WHOLE, _blocks(255)),
    OddC3d("names in small letters", FLOATS, _small),
    OddC3d("groups after their parameters", FLOATS, _groups_last),
    OddC3d("POINT in two groups", FLOATS, _group_twice),
    OddC3d("no group POINT", FLOATS, _groupless, "belongs to no group", named=False),
    OddC3d("data at block 0 by the header", FLOATS, byte(16, 0), "data into block 0"),
    OddC3d("data at block 2 by the header", FLOATS, byte(16, 2), "data into block 2"),
    OddC3d("parameters at block 1", FLOATS, byte(0, 1), refused="parameters into block 1"),
    OddC3d("unknown processor", FLOATS, byte(515, 0), refused="processor type 0"),
)  # fmt: skip
"""Faults of the file's structure."""

COUNTS = (
    OddC3d("no POINT:USED", FLOATS, without("POINT", "USED"), "POINT:USED is missing"),
    OddC3d(
        "POINT:USED one too many", FLOATS, put("POINT", "USED", integers([_POINTS + 1])), "36 fill the file"
    ),
    OddC3d("header counts no points", FLOATS, word(1, 0), "36 fill the file"),
    OddC3d("header counts no analog numbers", FLOATS, word(2, 0), "the file has 540"),
    OddC3d("header counts no samples", FLOATS, word(9, 0), "the file has 54"),
    OddC3d("ANALOG:USED 0", FLOATS, put("ANALOG", "USED", integers([0]))),
    OddC3d("header counts no frames", FLOATS, word(4, 0), "the file has 120"),
    OddC3d("header counts 500 frames", FLOATS, word(4, 500), "the file has 120"),
    OddC3d("POINT:FRAMES 1", FLOATS, put("POINT", "FRAMES", integers([1]))),
    OddC3d("zeros after the data", FLOATS, ending(bytes(2048))),
    OddC3d("text after the data", FLOATS, ending(b"footer\n" * 100), "are not read"),
    OddC3d("half of the frames", FLOATS, cut(_FRAMES // 2), refused="cut short"),
)
"""Counts that are wrong in one place."""

RATES = (
    OddC3d("POINT:RATE 0", FLOATS, put("POINT", "RATE", floats([0.0]))),
    OddC3d("no POINT:RATE", FLOATS, without("POINT", "RATE")),
    OddC3d("POINT:RATE negative", FLOATS, put("POINT", "RATE", floats([-100.0])), _NOT_USED),
    OddC3d("POINT:RATE not a number", FLOATS, put("POINT", "RATE", floats([np.nan])), _NOT_USED),
    OddC3d("POINT:RATE against both others", FLOATS, put("POINT", "RATE", floats([77.0])), _NOT_USED),
    OddC3d(
        "rate of the analog samples alone", FLOATS, both(number(20, 0.0), put("POINT", "RATE", floats([0.0])))
    ),
    OddC3d(
        "no rate at all",
        FLOATS,
        both(both(number(20, 0.0), without("POINT", "RATE")), without("ANALOG", "RATE")),
        refused="write the frame rate into POINT:RATE",
    ),
)
"""Frame rates."""

SCALES = (
    OddC3d("floats, header scale positive", FLOATS, number(12, 0.1), "floats fill the file"),
    OddC3d("floats, both scales positive", FLOATS, both(number(12, 0.1), put("POINT", "SCALE", floats([0.1]))), "fill"),
    OddC3d("integers, header scale negative", WHOLE, number(12, -1.0), "integers fill the file"),
    OddC3d("integers, POINT:SCALE negative", WHOLE, put("POINT", "SCALE", floats([-1.0]))),
    OddC3d("integers, no POINT:SCALE", WHOLE, without("POINT", "SCALE")),
    OddC3d("ANALOG:SCALE too short", FLOATS, put("ANALOG", "SCALE", _FEW), "10 of 54 channels"),
    OddC3d("ANALOG:OFFSET too short", FLOATS, put("ANALOG", "OFFSET", integers([0])), "1 of 54 channels"),
    OddC3d("ANALOG:GEN_SCALE empty", FLOATS, put("ANALOG", "GEN_SCALE", b"\x04\x01\0\0"), "lacks ANALOG:GEN_SCALE"),
)  # fmt: skip
"""Sizes of numbers and scales."""

NAMES = (
    OddC3d("unit mete", FLOATS, put("POINT", "UNITS", words([b"mete"])), refused="--unit"),
    OddC3d("unit in capitals", FLOATS, put("POINT", "UNITS", words([b"MM"]))),
    OddC3d("no POINT:UNITS", FLOATS, without("POINT", "UNITS"), "taken as mm"),
    OddC3d("no labels", FLOATS, without("POINT", "LABELS"), "have no label", named=False),
    OddC3d("labels in three lists", FLOATS, _labels_in_three),
    OddC3d("labels without points", FLOATS, _more_labels, "names 1 points more"),
    OddC3d("equal labels", FLOATS, put("POINT", "LABELS", words([b"AA"] * _POINTS)), "were renamed", named=False),
    OddC3d("numbers for labels", FLOATS, put("POINT", "LABELS", floats(np.ones(_POINTS))), "no label", named=False),
    OddC3d("events without a time", EVENTS, put("EVENT", "TIMES", _TIMELESS), "have no time", events=False),
    OddC3d("events not in rows", EVENTS, put("EVENT", "TIMES", floats([0.5, 1.0, 1.5])), "left out", events=False),
    OddC3d("header event without a time", FLOATS, _header_events, "1 of 2 events have no time", events=False),
)  # fmt: skip
"""Units, labels and events."""

PLATES = (
    OddC3d("ORIGIN under another name", FLOATS, _renamed_origin, "lacks FORCE_PLATFORM:ORIGIN"),
    OddC3d("no FORCE_PLATFORM:USED", FLOATS, without("FORCE_PLATFORM", "USED"), "that of TYPE, 9"),
    OddC3d(
        "99 plates used",
        FLOATS,
        put("FORCE_PLATFORM", "USED", integers([99])),
        "90 force plates are left out",
    ),
    OddC3d("channels in one row", FLOATS, put("FORCE_PLATFORM", "CHANNEL", _CHANNELS)),
    OddC3d("no CORNERS", FLOATS, without("FORCE_PLATFORM", "CORNERS"), "no usable CORNERS", plates=False),
)
"""Force plates."""

ODD: tuple[OddC3d, ...] = (*STRUCTURE, *COUNTS, *RATES, *SCALES, *NAMES, *PLATES)
"""All kinds."""
