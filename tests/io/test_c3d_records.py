"""Parameter records are walked as stored, and damaged ones are noticed."""

import re
import struct

import pytest

from mbkf.io.c3d_records import walk_parameters


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
    walked = walk_parameters(section, order)
    found = walked.records
    assert walked.groups == {2: "POINT"} and not walked.faults and walked.ended
    assert [(item.name, item.kind, item.dimensions, item.data[:6]) for item in found[1:]] == [
        ("LABELS", -1, (3, 2), b"abcdef")
    ]
    assert walked.integer("POINT", "USED", order) == 41000
    assert walked.integer("POINT", "LABELS", order) is None


def test_the_last_record_may_end_without_a_distance():
    body = struct.pack("<bb1sHbBf", 1, 1, b"R", 0, 4, 0, 2.5)
    walked = walk_parameters(group(1, "G") + body, "<")
    assert struct.unpack("<f", walked.records[0].data) == (2.5,) and not walked.faults


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
    found = walk_parameters(section, "<")
    assert len(found.faults) == 1 and re.search(reason, found.faults[0]) and not found.records


SOUND = group(1, "G") + parameter(1, "A", 1, (), b"\x05")


@pytest.mark.parametrize(
    ("odd", "lost"),
    [
        (parameter(7, "X", 2, (), b"\0\0"), ("", "X")),
        (parameter(1, "X", 3, (), b"\0\0"), ("G", "X")),
        (parameter(1, "X", 4, (200, 200), b"\0" * 8), ("G", "X")),
        (parameter(1, "\x01", 1, (), b"\x07"), None),
    ],
)
def test_a_damaged_record_costs_only_itself(odd, lost):
    found = walk_parameters(SOUND + odd + parameter(1, "B", 1, (), b"\x06"), "<")
    assert [(one.name, one.data) for one in found.records] == [("A", b"\x05"), ("B", b"\x06")]
    assert len(found.faults) == 1 and found.ended and found.lost == ((lost,) if lost else ())
    assert found.may_lack("G", ("X",)) == (lost is not None) and not found.may_lack("G", ("A", "B"))


def test_a_record_that_points_beyond_the_section_is_its_last():
    last = bytearray(parameter(1, "B", 1, (), b"\x06"))
    struct.pack_into("<H", last, 3, 9000)
    found = walk_parameters(SOUND + bytes(last), "<")
    assert [one.name for one in found.records] == ["A", "B"] and not found.ended
    assert found.faults == ("the record B points beyond the section",)
    assert found.may_lack("G", ("A", "C")) and not found.may_lack("G", ("A", "B"))


@pytest.mark.parametrize(
    ("step", "fault"),
    [(9000, "beyond the section"), (1, "at no record"), (2, "at no record"), (5, "at no record")],
)
def test_a_record_that_points_elsewhere_is_followed_by_its_own_length(step, fault):
    odd = bytearray(parameter(1, "B", 1, (), b"\x06"))
    struct.pack_into("<H", odd, 3, step)
    found = walk_parameters(SOUND + bytes(odd) + parameter(1, "C", 1, (), b"\x07") + bytes(9), "<")
    assert [(one.name, one.data[:1]) for one in found.records] == [
        ("A", b"\x05"),
        ("B", b"\x06"),
        ("C", b"\x07"),
    ]
    assert found.faults == (f"the record B points {fault}; its own length leads to the next",)
    assert found.ended and not found.may_lack("G", ("X",)) and found.length == len(SOUND) + 2 * len(odd)


def test_room_after_a_record_is_passed_over():
    roomy = struct.pack("<bb1sHbBBB", 1, 1, b"B", 8, 1, 0, 6, 0) + b"\x02\x01"
    found = walk_parameters(SOUND + roomy + parameter(1, "C", 1, (), b"\x07"), "<")
    assert [one.name for one in found.records] == ["A", "B", "C"] and not found.faults


def test_after_damage_no_record_replaces_one_that_came_before():
    twice = SOUND + parameter(1, "A", 1, (), b"\x06")
    assert walk_parameters(twice, "<").records[0].data == b"\x06"
    odd = SOUND + parameter(1, "X", 9, (), b"\0\0") + group(1, "H") + parameter(1, "A", 9, (), b"\x06")
    found = walk_parameters(odd + parameter(1, "A", 1, (), b"\x06"), "<")
    assert found.groups == {1: "G"} and [one.data for one in found.records] == [b"\x05"]


def test_names_of_other_letters_and_filled_up_ones_are_text():
    record = parameter(1, "Gr..e", 1, (), b"\x07").replace(b"..", b"\xf6\xdf")
    found = walk_parameters(group(1, "G\0\0") + record, "<")
    assert found.groups == {1: "G"} and found.records[0].name == "GRÖSSE" and not found.faults
