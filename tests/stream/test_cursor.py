"""A cursor reads the fields of a packet in order and never beyond its end, in the name of its protocol."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet.cursor import Cursor
from mbkf.stream.vicon.objects import Fields

KINDS = {"NatNet": lambda data: Cursor(data, 0, len(data)), "Vicon": Fields}


@pytest.mark.parametrize("protocol", sorted(KINDS))
def test_fields_are_read_in_order(protocol):
    cursor = KINDS[protocol](struct.pack("<I2fHd", 9, 1.0, 2.0, 4, 0.5))
    assert cursor.integer() == 9
    np.testing.assert_array_equal(cursor.rows(np.dtype("<f4"), 2), [1.0, 2.0])
    assert cursor.fields(struct.Struct("<Hd")) == (4, 0.5)
    assert cursor.at == cursor.end and not len(cursor.rows(np.dtype("<f4"), 0))


@pytest.mark.parametrize("protocol", sorted(KINDS))
@pytest.mark.parametrize(
    ("data", "read"),
    [
        (b"\1\0\0", lambda c: c.integer()),
        (bytes(11), lambda c: c.rows(np.dtype("<f4"), 3)),
        (bytes(11), lambda c: c.rows(np.dtype("<f4"), 2**32)),
        (struct.pack("<I", 2**32 - 1), lambda c: c.count(1)),
        (struct.pack("<I", 2) + bytes(7), lambda c: c.count(4)),
    ],
)
def test_fields_beyond_the_end_are_refused(protocol, data, read):
    with pytest.raises(InvalidPacket, match=f"{protocol}: "):
        read(KINDS[protocol](data))
