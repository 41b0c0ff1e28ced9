"""C3D files of all processors and formats are decoded to the same; what contradicts itself is settled or told."""

import struct
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import MbkfError
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import Processor, check_layout
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import standing_points
from tests.io.c3d_bytes import DEC, INTEL, MIPS, c3d_bytes, floats, integers

RNG = np.random.default_rng(0)
POINTS = np.round(standing_points(12, 5), 1)
ANALOGS = np.round(RNG.normal(0.0, 50.0, (12, 3, 2)))
KINDS = list(product((INTEL, DEC, MIPS), (None, 0.1)))


def decoded(path, content):
    path.write_bytes(content)
    return decode(path, check_layout(path))


@pytest.mark.parametrize(("processor", "scale"), KINDS)
def test_all_formats_are_read_alike(tmp_path, processor, scale):
    seen = RNG.random(POINTS.shape[:2]) < 0.8
    content = c3d_bytes(
        POINTS, ANALOGS, processor=processor, scale=scale, seen=seen, offset=7, gain=2.0,
        events=(("RHS", 1.25), ("LTO", 2.5)),
    )  # fmt: skip
    found = decoded(tmp_path / "x.c3d", content)
    np.testing.assert_allclose(found.points, POINTS, atol=1e-4)
    np.testing.assert_array_equal(found.residuals >= 0.0, seen)
    np.testing.assert_allclose(found.analogs, ANALOGS.reshape(-1, 2).T, atol=2.0 if scale else 1e-4)
    assert found.rate_hz == 100.0 and found.events == (("RHS", 1.25), ("LTO", 2.5)) and found.notes == ()
    assert found.parameters.texts("POINT", "LABELS") == ["M0", "M1", "M2", "M3", "M4"]


@given(st.lists(st.floats(width=32).filter(lambda x: x == 0.0 or 1e-30 < abs(x) < 1e30), min_size=1))
def test_floats_of_every_processor_are_the_numbers_they_were_made_of(values):
    for processor in Processor:
        found = processor.floats(floats(values, processor.value))
        np.testing.assert_allclose(found, np.float32(values), rtol=1e-7)


@pytest.mark.parametrize("left_out", [("OFFSET",), ("SCALE",), ("OFFSET", "SCALE", "GEN_SCALE")])
def test_analog_parameters_may_be_missing(tmp_path, left_out):
    found = decoded(tmp_path / "x.c3d", c3d_bytes(POINTS, ANALOGS, without=left_out))
    np.testing.assert_allclose(found.analogs, ANALOGS.reshape(-1, 2).T, atol=1e-4)


@pytest.mark.parametrize("stated", [True, False])
def test_offsets_of_an_unsigned_range_are_no_signed_ones(tmp_path, stated):
    extra = ((2, "FORMAT", -1, (8,), b"UNSIGNED"),) if stated else ()
    offset = 33000 if stated else 40000
    found = decoded(tmp_path / "x.c3d", c3d_bytes(POINTS, ANALOGS, scale=0.1, offset=offset, extra=extra))
    np.testing.assert_allclose(found.analogs, ANALOGS.reshape(-1, 2).T)
    assert bool(found.notes) is not stated


def test_a_header_that_contradicts_a_file_too_short_to_tell_is_refused(tmp_path):
    with pytest.raises(MbkfError, match="ANALOG:USED is 0, the header counts 1"):
        decoded(tmp_path / "x.c3d", c3d_bytes(POINTS, header_analogs=1))


def test_a_header_that_counts_analog_numbers_which_are_not_there_is_overruled(tmp_path):
    found = decoded(tmp_path / "x.c3d", c3d_bytes(np.repeat(POINTS, 20, axis=0), header_analogs=6))
    np.testing.assert_allclose(found.points, np.repeat(POINTS, 20, axis=0), atol=1e-4)
    assert "the header counts 6 analog numbers a frame, the file has 0" in found.notes


FRAMES = 236  # fill their last block but for less than a frame
MANY = np.repeat(POINTS, 20, axis=0)[:FRAMES] + np.arange(FRAMES)[:, None, None]
SAMPLES = np.round(RNG.normal(0.0, 50.0, (FRAMES, 3, 2)))


def test_a_header_that_counts_a_frame_too_many_is_read_as_what_fits(tmp_path):
    found = decoded(tmp_path / "x.c3d", c3d_bytes(MANY, SAMPLES, last=FRAMES + 1))
    np.testing.assert_allclose(found.points, MANY, atol=1e-4)
    np.testing.assert_allclose(found.analogs, SAMPLES.reshape(-1, 2).T, atol=1e-4)
    assert "the header counts 237 frames, the file has 236" in found.notes


def test_frames_that_count_from_0_are_as_many_as_the_parameters_state(tmp_path):
    """A frame of zeros would fit into the rest of the last block."""
    content = c3d_bytes(POINTS, first=0, last=12, extra=((1, "FRAMES", 2, (), integers([12], INTEL)),))
    found = decoded(tmp_path / "x.c3d", content)
    np.testing.assert_allclose(found.points, POINTS, atol=1e-4)
    assert "the header counts 13 frames, the file has 12" in found.notes


@pytest.mark.parametrize(("channels", "samples"), [(3, 3), (2, 4)])
def test_channels_or_samples_of_which_one_fewer_fits_are_read_as_what_fits(tmp_path, channels, samples):
    """Header and parameters agree on 12 where 11 are stored."""
    extra = (
        (2, "USED", 2, (), integers([channels], INTEL)),
        (2, "RATE", 4, (), floats([100.0 * samples], INTEL)),
    )
    content = c3d_bytes(
        MANY, SAMPLES, header_analogs=channels * samples, extra=extra, without=("USED", "RATE")
    )
    content = content[:18] + struct.pack("<H", samples) + content[20:]
    found = decoded(tmp_path / "x.c3d", content)
    np.testing.assert_allclose(found.points, MANY, atol=1e-4)
    np.testing.assert_allclose(found.analogs, SAMPLES.reshape(-1, 2).T, atol=1e-4)
    assert f"the header counts {channels * samples} analog numbers a frame, the file has 6" in found.notes


@pytest.mark.parametrize("blocks", range(2, 11))
def test_a_file_that_lacks_more_than_a_frame_is_refused(tmp_path, blocks):
    with pytest.raises(MbkfError, match="cut short"):
        decoded(tmp_path / "x.c3d", c3d_bytes(MANY, SAMPLES)[: -512 * blocks])


@pytest.mark.parametrize(
    ("stated", "header"), [(-1.0, 0.1), (0.0, 0.1), (0.1, 0.0), (np.nan, 0.1), (-0.1, 0.0)]
)
def test_integer_points_take_the_scale_that_can_be_one(tmp_path, stated, header):
    content = bytearray(c3d_bytes(POINTS, scale=0.1, extra=((1, "SCALE", 4, (), floats([stated], INTEL)),)))
    content[12:16] = floats([header], INTEL)
    np.testing.assert_allclose(decoded(tmp_path / "x.c3d", content).points, POINTS, atol=1e-3)


def test_integer_points_without_a_scale_are_refused(tmp_path):
    content = bytearray(c3d_bytes(POINTS, scale=0.1, extra=((1, "SCALE", 4, (), floats([0.0], INTEL)),)))
    content[12:16] = bytes(4)
    with pytest.raises(MbkfError, match="neither POINT:SCALE nor the header"):
        decoded(tmp_path / "x.c3d", content)


@pytest.mark.parametrize(
    ("added", "remark"), [(bytes(2048), ""), (b"made by X", ""), (b"x" * 600, "bytes after the last frame")]
)
def test_bytes_after_the_last_frame_are_reported(tmp_path, added, remark):
    content = c3d_bytes(MANY, SAMPLES)
    unread = [note for note in decoded(tmp_path / "x.c3d", content + added).notes if "not read" in note]
    assert (remark in unread[0]) if remark else not unread


LONG = 66000


@pytest.mark.parametrize("told", ["trial", "long", "frames"])
def test_a_trial_beyond_the_header_s_words_is_read_whole(tmp_path, told):
    points = np.zeros((LONG, 1, 3)) + np.arange(LONG)[:, None, None]
    trial = [(3, f"ACTUAL_{w}_FIELD", 2, (2,), integers([n % 65536, n // 65536], INTEL))
             for w, n in (("START", 1), ("END", LONG))]  # fmt: skip
    extra = {
        "trial": trial,
        "long": [(1, "LONG_FRAMES", 4, (), floats([LONG], INTEL))],
        "frames": [(1, "FRAMES", 4, (), floats([LONG], INTEL))],
    }[told]
    found = decoded(tmp_path / "x.c3d", c3d_bytes(points, extra=tuple(extra)))
    assert len(found.points) == LONG
    np.testing.assert_array_equal(found.points[:, 0, 0], np.arange(LONG))


def test_a_long_trial_that_tells_no_length_is_refused(tmp_path):
    path = tmp_path / "x.c3d"
    path.write_bytes(c3d_bytes(np.zeros((LONG, 1, 3))))
    with pytest.raises(MbkfError, match="can count no further"):
        decode(path, check_layout(path))


def test_words_of_the_header_that_overran_are_put_right(tmp_path):
    extra = tuple(
        (3, f"ACTUAL_{w}_FIELD", 2, (2,), integers([n % 65536, n // 65536], INTEL))
        for w, n in (("START", 1), ("END", LONG))
    )
    found = decoded(tmp_path / "x.c3d", c3d_bytes(np.ones((LONG, 1, 3)), extra=extra, last=LONG % 65536))
    assert len(found.points) == LONG and "the file has 66000" in found.notes[0]


def test_the_largest_and_the_smallest_number_of_a_vax():
    words = [0x7FFF, 0xFFFF, 0xFFFF, 0xFFFF, 0x0180, 0, 0x0100, 0, 0x0080, 0, 0, 0]
    largest = (2.0 - 2.0**-23) * 2.0**126
    found = Processor.DEC.floats(np.array(words, "<u2").tobytes())
    np.testing.assert_array_equal(found, [largest, -largest, 2.0**-126, 0.0, 0.0, 0.0])


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(KINDS), st.integers(1, 12), st.booleans())
def test_a_damaged_file_is_read_or_refused_in_our_own_words(tmp_path_factory, seed, kind, count, inside):
    """Random bytes in header and parameters, or anywhere; the file may also be cut."""
    rng = np.random.default_rng(seed)
    content = bytearray(c3d_bytes(POINTS, ANALOGS, processor=kind[0], scale=kind[1]))
    end = 1536 if inside else len(content)
    for at in rng.integers(0, end, count):
        content[at] = rng.integers(0, 256)
    path = tmp_path_factory.mktemp("damaged") / "x.c3d"
    path.write_bytes(content[: int(rng.integers(0, len(content) + 1))] if rng.random() < 0.2 else content)
    try:
        read_c3d(path, CaptureOptions())
    except MbkfError as error:
        assert str(path) in str(error)
