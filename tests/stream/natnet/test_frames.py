"""Frames of every protocol are read as they were packed; damaged ones are refused, whatever the damage."""

import struct
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.frames import Frame, read_frame
from tests.stream.natnet import layouts

SETS = (
    ("all", np.arange(15.0).reshape(5, 3)),
    ("Ä", np.arange(6.0).reshape(2, 3)),
    ("none", np.zeros((0, 3))),
)
POINTS = np.arange(9.0).reshape(3, 3) - 4.0
MARKERS = ((65537, np.array([1.0, 2.0, 3.0]), 1), (3, np.array([4.0, 5.0, 6.0]), 0x12))
PLATES = ((1, np.arange(60.0).reshape(6, 10)), (4, np.arange(16.0).reshape(8, 2)))


def whole(version):
    return layouts.frame(version, 5, 0.5, SETS, POINTS, MARKERS, PLATES)


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_a_frame_is_read_past_all_that_is_not_wanted(version):
    found = read_frame(whole(version), version)
    assert (found.number, found.time_s) == (5, 0.5)
    assert list(found.sets) == [name for name, _ in SETS]
    for name, at in SETS:
        np.testing.assert_array_equal(found.sets[name], at)
    np.testing.assert_array_equal(found.points, POINTS)
    for one, (identity, position, flags) in zip(found.labelled, MARKERS, strict=True):
        assert (one["id"], one["flags"]) == (identity, flags)
        assert (one["size"], one["residual"]) == (np.float32(0.014), 0.5)
        np.testing.assert_array_equal(one["position"], position)
    assert found.plates.numbers == [1, 4]
    for samples, (_, sent) in zip(found.plates.samples, PLATES, strict=True):
        np.testing.assert_array_equal(samples, sent)


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_an_empty_frame_is_read(version):
    found = read_frame(layouts.frame(version), version)
    assert found.sets == {}
    assert len(found.plates.numbers) == len(found.plates.samples) == 0
    assert found.points.shape == (0, 3)
    assert len(found.labelled) == 0


def test_a_plate_with_uneven_channels_has_no_samples():
    uneven = [[1.0, 2.0], [3.0], [4.0, 5.0]]
    found = read_frame(layouts.frame((4, 0), plates=[(1, uneven), (2, [[6.0]]), (3, [])]), (4, 0))
    assert found.plates.numbers == [1, 2, 3]
    assert found.plates.samples[0].size == found.plates.samples[2].size == 0
    np.testing.assert_array_equal(found.plates.samples[1], [[6.0]])


@pytest.mark.parametrize("others", [(6, 4), (5, 4), (6, 3), (8, 3), (4, 7), (1, 34)])
def test_plates_are_read_alike_whether_all_have_equal_channels_or_not(others):
    """Shapes that take as many bytes as the first plate's, or more, or less."""
    rng = np.random.default_rng(0)
    sent = [rng.normal(size=shape).astype(np.float32) for shape in ((6, 4), (6, 4), others, (6, 4))]
    found = read_frame(
        layouts.frame((4, 1), plates=list(zip((3, 9, 1, 4), sent, strict=True))), (4, 1)
    ).plates
    assert found.numbers == [3, 9, 1, 4]
    for samples, expected in zip(found.samples, sent, strict=True):
        np.testing.assert_array_equal(samples, expected)


@given(
    number=st.integers(0, 2**32 - 1),
    time_s=st.floats(0.0, 1e5),
    sizes=st.tuples(st.integers(0, 60), st.integers(0, 20), st.integers(0, 3), st.integers(0, 12)),
    seed=st.integers(0, 2**16),
)
def test_what_the_player_packs_is_read_back(number, time_s, sizes, seed):
    """Positions and samples lose nothing but digits; hidden markers are noughts that are marked."""
    rng = np.random.default_rng(seed)
    markers, points = rng.normal(size=(sizes[0], 3)), rng.normal(size=(sizes[1], 3))
    plates = rng.normal(size=(sizes[2], sizes[3], 6))
    hidden = rng.uniform(size=len(markers)) < 0.2
    markers[hidden] = np.nan
    found = read_frame(packets.frame(number, time_s, "walk", markers, points, plates), (4, 0))
    assert (found.number, found.time_s) == (number, time_s)
    if len(markers):
        np.testing.assert_array_equal(found.sets["walk"], np.nan_to_num(markers).astype(np.float32))
    np.testing.assert_array_equal(found.points, points.astype(np.float32))
    flags = found.labelled["flags"]
    np.testing.assert_array_equal(flags & packets.OCCLUDED != 0, [*hidden, *np.zeros(len(points), bool)])
    np.testing.assert_array_equal(flags & packets.UNLABELLED != 0, np.arange(len(flags)) >= len(markers))
    np.testing.assert_array_equal(
        found.labelled["id"] & 0xFFFF, [*range(1, len(markers) + 1), *range(1, len(points) + 1)]
    )
    assert found.plates.numbers == list(range(1, len(plates) + 1))
    for k, samples in enumerate(plates):
        np.testing.assert_array_equal(found.plates.samples[k], samples.T.astype(np.float32))


def read_or_refused(packet, version):
    try:
        assert isinstance(read_frame(packet, version), Frame)
    except InvalidPacket:
        return False
    return True


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_a_frame_that_breaks_off_anywhere_is_refused(version):
    packet = whole(version)
    for length in range(len(packet)):
        assert not read_or_refused(packet[:length], version)
    after_the_time = len(packet) - (30 if version < (4, 1) else 38)
    for length in range(4, len(packet)):
        assert read_or_refused(layouts.cut(packet, length), version) == (length >= after_the_time)


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_a_huge_number_anywhere_allocates_nothing(version):
    packet = whole(version)
    tracemalloc.start()
    for at in range(4, len(packet) - 4):
        for value in (2**32 - 1, 2**31 - 1, 65_535):
            read_or_refused(packet[:at] + struct.pack("<I", value) + packet[at + 4 :], version)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


@settings(max_examples=300)
@given(
    version=st.sampled_from(layouts.VERSIONS),
    told=st.sampled_from(layouts.VERSIONS),
    changes=st.lists(st.tuples(st.integers(0, 2**16), st.integers(0, 255)), max_size=8),
)
def test_a_damaged_frame_is_read_or_refused(version, told, changes):
    packet = bytearray(whole(version))
    for at, value in changes:
        packet[at % len(packet)] = value
    read_or_refused(bytes(packet), told)


@settings(max_examples=300)
@given(payload=st.binary(max_size=200), version=st.sampled_from(layouts.VERSIONS))
def test_noise_is_read_or_refused(payload, version):
    read_or_refused(packets.message(packets.FRAME, payload), version)


@pytest.mark.parametrize("version", layouts.VERSIONS)
@pytest.mark.parametrize("flags", [0, 1, 2, 3])
def test_a_change_of_the_models_is_read_from_the_last_fields(version, flags):
    whole = bytearray(layouts.frame(version))
    whole[-6:-4] = struct.pack("<H", flags)
    assert read_frame(bytes(whole), version).changed == (flags >= 2)
