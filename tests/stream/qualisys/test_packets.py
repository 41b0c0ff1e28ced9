"""Packets of QTM are read to their last byte, and refused where their counts do not fit."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.qualisys import packets
from mbkf.stream.qualisys.packets import read_frame

HEAD = struct.pack("<QII", 10_000, 7, 3)


def part(kind, payload):
    return struct.pack("<II", 8 + len(payload), kind) + payload


def points(rows):
    return struct.pack("<Ihh", len(rows), 0, 0) + np.array(rows, dtype="<f4").tobytes()


def forces(*plates):
    made = [
        struct.pack("<III", k + 1, len(rows), first) + np.array(rows, dtype="<f4").tobytes()
        for k, (first, rows) in enumerate(plates)
    ]
    return struct.pack("<I", len(made)) + b"".join(made)


MARKERS = part(packets.MARKERS_RESIDUAL, points([[1, 2, 3, 0.5], [np.nan, 5, 6, 0.25]]))
BARE = part(packets.POINTS_RESIDUAL, points([[7, 8, 9, 1, 0.125]]))
LOADS = part(packets.FORCE, forces((70, [range(9), range(9, 18)]), (70, [])))
WHOLE = HEAD + MARKERS + BARE + LOADS


def test_a_frame_holds_its_components():
    found = read_frame(WHOLE)
    assert (found.number, found.time_us) == (7, 10_000)
    np.testing.assert_array_equal(found.points[packets.MARKERS_RESIDUAL], [[1, 2, 3], [np.nan, 5, 6]])
    np.testing.assert_array_equal(found.points[packets.POINTS_RESIDUAL], [[7, 8, 9]])
    np.testing.assert_array_equal(found.residuals[packets.MARKERS_RESIDUAL], [0.5, 0.25])
    np.testing.assert_array_equal(found.residuals[packets.POINTS_RESIDUAL], [0.125])
    one, other = found.forces
    assert (one.plate, one.first, other.plate, len(other.samples)) == (1, 70, 2, 0)
    np.testing.assert_array_equal(one.samples, np.arange(18).reshape(2, 9))


def test_other_components_are_skipped():
    found = read_frame(
        struct.pack("<QII", 1, 2, 2) + part(17, b"timecode") + part(packets.MARKERS, points([[1, 2, 3]]))
    )
    np.testing.assert_array_equal(found.points[packets.MARKERS], [[1, 2, 3]])
    assert found.forces is None and found.residuals == {}


@pytest.mark.parametrize("end", range(0, len(WHOLE) - 1, 5))
def test_a_packet_that_is_cut_off_is_refused(end):
    with pytest.raises(InvalidPacket, match="QTM"):
        read_frame(WHOLE[:end])


@pytest.mark.parametrize(
    "payload",
    [
        struct.pack("<QII", 1, 2, 65),
        struct.pack("<QII", 1, 2, 1) + struct.pack("<II", 7, 1) + bytes(8),
        struct.pack("<QII", 1, 2, 1) + part(packets.MARKERS, struct.pack("<Ihh", 10**6, 0, 0)),
        struct.pack("<QII", 1, 2, 1) + part(packets.POINTS, b"123"),
        struct.pack("<QII", 1, 2, 1) + part(packets.FORCE, b"12"),
        struct.pack("<QII", 1, 2, 1) + part(packets.FORCE, struct.pack("<I", 10**6)),
        struct.pack("<QII", 1, 2, 1) + part(packets.FORCE, struct.pack("<IIII", 1, 1, 10**6, 0)),
        struct.pack("<QII", 1, 2, 1)
        + part(packets.FORCE, struct.pack("<IIII", 1, 1, 20_001, 0) + bytes(20_001 * 36)),
    ],
)
def test_counts_that_do_not_fit_are_refused(payload):
    with pytest.raises(InvalidPacket, match="QTM"):
        read_frame(payload)


def test_texts_end_at_their_nought():
    assert packets.text_of(b"Ok\0") == "Ok"
    assert packets.packet(packets.COMMAND, b"Ok\0") == b"\x0b\0\0\0\1\0\0\0Ok\0"
