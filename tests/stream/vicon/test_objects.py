"""Objects of DataStream as the headers lay them out, and those that claim more than they hold."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.vicon import objects


def text(word):
    return struct.pack("<I", len(word)) + word.encode()


def test_requests_as_bytes():
    assert objects.request(streaming=True) == bytes.fromhex("01002b1a 09000000 a2860100 01000000 01")
    listed = objects.packet(objects.enums((6, 1, 100004)))
    assert listed == bytes.fromhex("01002b1a 18000000 a1860100 10000000 03000000 01000000 06000000 a4860100")


def test_blocks_by_type_in_order():
    data = objects.block(6, b"a") + objects.block(5, b"") + objects.block(6, b"bc")
    assert objects.blocks(data) == {6: [b"a", b"bc"], 5: [b""]}


@pytest.mark.parametrize(
    "data", [b"\1\2\3", struct.pack("<II", 6, 1), struct.pack("<II", 6, 2**32 - 1) + b"x"]
)
def test_blocks_that_are_cut_off(data):
    with pytest.raises(InvalidPacket, match="Vicon"):
        objects.blocks(data)


def test_a_subject_with_segments_and_markers():
    segment = struct.pack("<2I6f", 0, 1, *range(6)) + text("pelvis")
    markers = b"".join(struct.pack("<I", k) + text(name) for k, name in ((4, "LASI"), (9, "RASI")))
    data = (
        struct.pack("<I", 3) + text("Anna") + struct.pack("<I", 1) + segment + struct.pack("<I", 2) + markers
    )
    found = objects.read_subject(data)
    assert (found.number, found.name, found.markers) == (3, "Anna", {4: "LASI", 9: "RASI"})
    with pytest.raises(InvalidPacket, match="left"):
        objects.read_subject(data[:-1])


def test_markers_and_points():
    covariance = np.eye(3).ravel()
    marker = struct.pack("<2Id3d9dI", 3, 4, 7.0, 1.0, 2.0, 3.0, *covariance, 5)
    ids, places = objects.read_markers(struct.pack("<I", 1) + marker)
    assert ids.tolist() == [[3, 4]] and places.tolist() == [[1.0, 2.0, 3.0]]
    point = objects.read_points(struct.pack("<I", 1) + marker[8:])
    assert point.tolist() == [[1.0, 2.0, 3.0]]
    with pytest.raises(InvalidPacket, match="1000000 things cannot stand"):
        objects.read_points(struct.pack("<I", 10**6) + marker)


def test_samples_follow_component_by_component():
    found = objects.read_samples(struct.pack("<4I6f", 12, 3, 1, 6, *range(6)))
    assert (found.frame, found.device) == (12, 3)
    assert found.values.tolist() == [[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]]
    with pytest.raises(InvalidPacket, match="4 numbers are not samples"):
        objects.read_samples(struct.pack("<4I4f", 12, 3, 1, 4, *range(4)))
    count = 3 * objects.MOST_SAMPLES + 3
    with pytest.raises(InvalidPacket, match="more than 20000"):
        objects.read_samples(struct.pack("<4I", 12, 3, 1, count) + bytes(4 * count))


def test_a_plate():
    found = objects.read_plate(struct.pack("<I30f", 7, *range(30)))
    assert found.device == 7 and found.translation_mm.tolist() == [0, 1, 2]
    assert found.rotation.tolist() == [[3, 4, 5], [6, 7, 8], [9, 10, 11]]
    assert found.bounds_mm.tolist() == [[12, 13, 14], [15, 16, 17]] and found.sensor_mm.tolist() == [
        18,
        19,
        20,
    ]


def test_a_channel_a_device_and_lists():
    channel = (
        struct.pack("<2I", 7, 2) + text("Force") + struct.pack("<I", 3) + text("Fx") + text("Fy") + text("Fz")
    )
    assert objects.read_channel(channel) == (7, 2, ("Fx", "Fy", "Fz"))
    assert objects.read_device(struct.pack("<IQ", 7, 1_350_000) + text("Plate")) == (7, 1_350_000)
    assert objects.read_numbers(struct.pack("<3I", 2, 5, 6)) == (5, 6)
    assert objects.read_unchanged(struct.pack("<6I", 1, 5, 1, 2, 6, 7)) == (6, 7)
