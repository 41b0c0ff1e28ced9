"""Parameter records are walked as stored, and damaged ones are noticed."""

import struct

import pytest

from mbkf.io.c3d_records import DamagedParameters, first_integer, walk_parameters


def group(number: int, name: str, order: str = "<") -> bytes:
    return struct.pack(f"{order}bb{len(name)}sHB", len(name), -number, name.encode(), 3, 0)


def parameter(
    number: int, name: str, kind: int, dimensions: tuple[int, ...], data: bytes, order="<"
) -> bytes:
    body = struct.pack("bB", kind, len(dimensions)) + bytes(dimensions) + data + b"\0"
    return struct.pack(f"{order}bb{len(name)}sH", -len(name), number, name.encode(), 2 + len(body)) + body


@pytest.mark.parametrize("order", ["<", ">"])
def test_records_are_found_in_order(order):
    section = group(2, "Point", order) + parameter(2, "used", 2, (), struct.pack(f"{order}H", 41000), order)
    section += parameter(2, "LABELS", -1, (3, 2), b"abcdef", order) + bytes(30)
    groups, found = walk_parameters(section, order)
    assert groups == {2: "POINT"}
    assert [(item.name, item.kind, item.dimensions, item.data[:6]) for item in found[1:]] == [
        ("LABELS", -1, (3, 2), b"abcdef")
    ]
    assert first_integer(found[0], order) == 41000
    assert first_integer(found[1], order) is None


def test_the_last_record_may_end_without_a_distance():
    body = struct.pack("<bb1sHbBf", 1, 1, b"R", 0, 4, 0, 2.5)
    _, found = walk_parameters(group(1, "G") + body, "<")
    assert struct.unpack("<f", found[0].data) == (2.5,)


@pytest.mark.parametrize(
    ("section", "reason"),
    [
        (b"\x20\x01abc", "reaches beyond"),
        (group(1, "G")[:-2] + b"\x00", "reaches beyond|points beyond"),
        (struct.pack("<bb1sHB", 1, -1, b"G", 900, 0), "points beyond"),
        (struct.pack("<bb1sHB", 1, -1, b"\x03", 3, 0), "not text"),
        (parameter(7, "X", 2, (), b"\0\0"), "no group"),
        (group(1, "G") + parameter(1, "X", 3, (), b"\0\0"), "no valid type"),
        (group(1, "G") + parameter(1, "X", 1, (1,) * 9, b"\0"), "no valid type"),
        (group(1, "G") + parameter(1, "X", 4, (200, 200), b"\0" * 8), "longer than its record"),
        (group(1, "G") + struct.pack("<bb1sHB", 1, 1, b"X", 3, 4), "is empty"),
    ],
)
def test_damage_is_noticed(section, reason):
    with pytest.raises(DamagedParameters, match=reason):
        walk_parameters(section, "<")
