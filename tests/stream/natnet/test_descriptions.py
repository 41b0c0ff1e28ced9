"""Descriptions of every protocol are read as they were packed; damaged ones are refused, whatever the damage."""

import struct
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.descriptions import Descriptions, MarkerSet, read_descriptions
from tests.stream.natnet import layouts

CORNERS = np.arange(12.0).reshape(4, 3)
SETS = (("all", ("A", "Ä", "B")), ("walk", ("A", "Ä")), ("none", ()))


def whole(version):
    plates = [
        layouts.described_plate(1, "left", CORNERS),
        layouts.described_plate(2, "", -CORNERS, ("a", "b"), 1),
    ]
    return layouts.descriptions(version, SETS, plates)


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_sets_and_plates_are_read_past_all_else(version):
    found = read_descriptions(whole(version), version)
    assert found.sets == tuple(MarkerSet(*one) for one in SETS)
    first, second = found.plates
    assert (first.number, first.serial, first.raw) == (1, "left", False)
    assert (second.number, second.serial, second.raw, second.channels) == (2, "", True, ("a", "b"))
    assert first.channels == packets.CHANNELS
    np.testing.assert_array_equal(first.corners_m, CORNERS)
    np.testing.assert_array_equal(second.corners_m, -CORNERS)
    np.testing.assert_allclose(first.offset_m, [0.01, 0.02, 0.03], rtol=1e-6)


def test_what_the_player_packs_is_read_back():
    rng = np.random.default_rng(0)
    made = [packets.ForcePlate(k, f"plate {k}", rng.normal(size=3), rng.normal(size=(4, 3))) for k in (1, 2)]
    found = read_descriptions(packets.descriptions("walk", ("A", "Ä"), made), (4, 0))
    assert found.sets == (MarkerSet("walk", ("A", "Ä")),)
    for plate, own in zip(found.plates, made, strict=True):
        assert (plate.number, plate.serial, plate.raw) == (own.number, own.serial, False)
        assert plate.channels == packets.CHANNELS
        np.testing.assert_array_equal(plate.corners_m, own.corners_m.astype(np.float32))
        np.testing.assert_array_equal(plate.offset_m, own.offset_m.astype(np.float32))


def test_something_unknown_is_passed_over_where_its_size_is_sent():
    found = read_descriptions(layouts.descriptions((4, 1), SETS, (), unknown=True), (4, 1))
    assert len(found.sets) == 3
    with pytest.raises(InvalidPacket, match="unknown kind 17"):
        read_descriptions(layouts.descriptions((4, 0), SETS, (), unknown=True), (4, 0))


def read_or_refused(packet, version):
    try:
        assert isinstance(read_descriptions(packet, version), Descriptions)
    except InvalidPacket:
        return False
    return True


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_descriptions_that_break_off_anywhere_are_refused(version):
    packet = whole(version)
    assert read_or_refused(packet, version)
    for length in range(len(packet)):
        assert not read_or_refused(packet[:length], version)
        if length >= 4:
            assert not read_or_refused(layouts.cut(packet, length), version)


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_a_huge_number_anywhere_allocates_nothing(version):
    packet = whole(version)
    tracemalloc.start()
    for at in range(4, len(packet) - 4):
        read_or_refused(packet[:at] + struct.pack("<I", 2**32 - 1) + packet[at + 4 :], version)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


@settings(max_examples=300)
@given(
    version=st.sampled_from(layouts.VERSIONS),
    told=st.sampled_from(layouts.VERSIONS),
    changes=st.lists(st.tuples(st.integers(0, 2**16), st.integers(0, 255)), max_size=8),
)
def test_damaged_descriptions_are_read_or_refused(version, told, changes):
    packet = bytearray(whole(version))
    for at, value in changes:
        packet[at % len(packet)] = value
    read_or_refused(bytes(packet), told)
