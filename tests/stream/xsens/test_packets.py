"""MVN's datagrams as the specification lays them out, and those that are none."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.xsens.packets import POSES, SEGMENTS, TRACKERS, read_datagram, read_items
from tests.stream.xsens_datagrams import datagram, pose, tracker

PUBLISHED = bytes.fromhex(
    "4d5854503032 0000002a 80 01 000004d2 00 01 00 00 0000 0020"
    "00000001 3f800000 40000000 40400000 3f800000 00000000 00000000 00000000"
)
"""One pelvis at (1, 2, 3), sample 42, 1234 ms, person 0: as a published reader's own test sends it."""


def test_a_datagram_of_one_segment():
    one = read_datagram(PUBLISHED)
    assert (one.kind, one.sample, one.part, one.last, one.items) == (POSES, 42, 0, True, 1)
    assert (one.time_ms, one.character, len(one.payload)) == (1234, 0, 32)
    ids, values = read_items(one)
    assert ids.tolist() == [1] and values.tolist() == [[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]]


def test_parts_are_counted_and_the_last_one_marked():
    first, last = (read_datagram(datagram(7, counter=k, items=[pose(1)])) for k in (0x01, 0x82))
    assert (first.part, first.last, last.part, last.last) == (1, False, 2, True)


@pytest.mark.parametrize("more", [(0.1, 0.2, 0.3), tuple(range(9))])
def test_trackers_of_both_lengths(more):
    ids, values = read_items(
        read_datagram(datagram(kind=TRACKERS, items=[tracker(16, more=more), tracker(17, more=more)]))
    )
    assert ids.tolist() == [16, 17]
    np.testing.assert_allclose(values[0], [1, 0, 0, 0, 0, 0, 0, *more], rtol=1e-6)


def test_a_header_without_a_size_is_of_an_older_version():
    assert len(read_datagram(datagram(items=[pose(1)], size=0)).payload) == 32


@pytest.mark.parametrize(
    "data",
    [
        PUBLISHED[:23],
        b"MXTQ02" + PUBLISHED[6:],
        b"MXTP0x" + PUBLISHED[6:],
        PUBLISHED[:-1],
    ],
)
def test_other_bytes_are_no_datagram(data):
    with pytest.raises(InvalidPacket, match="MVN"):
        read_datagram(data)


@pytest.mark.parametrize("items", [0, 2, 255])
def test_a_count_that_the_payload_does_not_hold(items):
    changed = bytearray(PUBLISHED)
    changed[11] = items
    with pytest.raises(InvalidPacket, match=f"{items} items of type 02 in 32 bytes"):
        read_items(read_datagram(bytes(changed)))


def test_segments_by_their_ids():
    assert struct.unpack(">I", pose(16)[:4])[0] == 16 and SEGMENTS[16] == "right_thigh"
    assert SEGMENTS[5] == "torso" and SEGMENTS[22] == "left_foot" and len(SEGMENTS) == 15
