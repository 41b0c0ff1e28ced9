"""A cursor reads points, texts and parts in order and never beyond the packet."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet.cursor import Cursor, opened


def over(data):
    return Cursor(data, 0, len(data))


def test_fields_are_read_in_order():
    cursor = over(struct.pack("<3f", 1.0, 2.0, 3.0) + "Ä".encode() + b"\0")
    np.testing.assert_array_equal(cursor.points(1), [[1.0, 2.0, 3.0]])
    assert cursor.text() == "Ä"
    assert cursor.at == cursor.end
    assert cursor.points(0).shape == (0, 3)


@pytest.mark.parametrize(
    ("data", "read"),
    [
        (bytes(11), lambda c: c.points(1)),
        (bytes(11), lambda c: c.points(2**32)),
        (b"abc", lambda c: c.text()),
        (struct.pack("<I", 2) + bytes(1), lambda c: c.part()),
        (struct.pack("<2I", 3, 8) + bytes(8), lambda c: c.sized_count(4)),
        (bytes(8), lambda c: (c.take(5), c.leave(4))),
    ],
)
def test_what_does_not_fit_is_refused(data, read):
    with pytest.raises(InvalidPacket):
        read(over(data))


def test_a_field_does_not_reach_beyond_the_stated_payload():
    number, cursor = opened(struct.pack("<HHI", 7, 2, 1) + b"more")
    assert number == 7
    with pytest.raises(InvalidPacket, match="4 bytes are wanted where 2 are left"):
        cursor.integer()


def test_text_that_is_no_utf8_is_replaced():
    assert over(b"\xff\xfea\0").text().endswith("a")


@pytest.mark.parametrize(
    "packet", [b"", b"\7", b"\7\0\0", struct.pack("<HH", 7, 1), struct.pack("<HHB", 7, 2, 0)]
)
def test_a_packet_shorter_than_it_states_is_refused(packet):
    with pytest.raises(InvalidPacket):
        opened(packet)
