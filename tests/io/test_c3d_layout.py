"""A file's header tells whether all of it is there."""

import struct

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import Plate, build_c3d, standing_points
from tests.io.c3d_bytes import DEC, INTEL, MIPS, c3d_bytes, floats, integers


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    channels = np.ones((120, 6))
    path = tmp_path_factory.mktemp("whole") / "whole.c3d"
    return build_c3d(path, standing_points(12, 9), plates=(Plate(2, channels),), first_frame=4).read_bytes()


def test_sizes_are_those_written(whole, tmp_path):
    path = tmp_path / "whole.c3d"
    path.write_bytes(whole)
    layout = check_layout(path)
    assert (layout.points, layout.analog_per_frame, layout.frames, layout.first_frame) == (9, 60, 12, 5)
    assert layout.bytes_per_frame == (4 * 9 + 60) * 4
    assert layout.frames_present >= 12
    assert layout.data_bytes >= 12 * layout.bytes_per_frame and not layout.counts_no_further


@pytest.mark.parametrize("share", [0.0, 1e-4, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97])
def test_a_file_cut_anywhere_is_refused(whole, tmp_path, share):
    path = tmp_path / "cut.c3d"
    data_end = (check_start(whole) - 1) * 512 + 12 * (4 * 9 + 60) * 4
    path.write_bytes(whole[: int(share * data_end)])
    with pytest.raises(FileFormatError, match=r"cut short|empty|not a C3D"):
        read_c3d(path, CaptureOptions())


def check_start(content: bytes) -> int:
    """Block of the data, from the ninth word of the header."""
    return struct.unpack_from("<H", content, 16)[0]


@pytest.mark.parametrize(
    "content", [b"hello, no motion in here" * 50, b"\x02\x51" + bytes(2000), bytes(4000)]
)
def test_other_files_are_refused(content, tmp_path):
    path = tmp_path / "other.c3d"
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="not a C3D file"):
        read_c3d(path, CaptureOptions())


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_c3d(tmp_path / "none.c3d", CaptureOptions())
    with pytest.raises(FileFormatError, match="is a folder"):
        read_c3d(tmp_path, CaptureOptions())


@pytest.mark.parametrize(("processor", "order", "word"), [(84, "<", 7), (85, "<", 6), (86, ">", 6)])
@pytest.mark.parametrize(("negative", "size"), [(True, 4), (False, 2)])
def test_size_of_a_number_follows_the_sign_of_the_scale(tmp_path, processor, order, word, negative, size):
    words = [0] * 256
    words[1:5] = [3, 0, 1, 2]
    words[8] = 3
    words[word] = 0xC000 if negative else 0x4000
    header = bytearray(struct.pack(f"{order}256H", *words))
    header[:2] = bytes([2, 0x50])
    path = tmp_path / "made.c3d"
    group = struct.pack(f"{order}bb5sHB", 5, -1, b"POINT", 3, 0)
    used = struct.pack(f"{order}bb4sHbBHB", 4, 1, b"USED", 0, 2, 0, 3, 0)
    section = bytes([1, 0x50, 1, processor]) + group + used
    path.write_bytes(bytes(header) + section.ljust(512, b"\0") + bytes(512))
    assert check_layout(path).bytes_per_number == size


def odd(whole, tmp_path, index, value):
    """The file with another 16-bit word in its header, by the byte at which it stands."""
    content = bytearray(whole)
    struct.pack_into("<H", content, index, value)
    path = tmp_path / "odd.c3d"
    path.write_bytes(content)
    return path


def test_header_and_parameters_must_agree(whole, tmp_path):
    with pytest.raises(FileFormatError, match="header counts"):
        read_c3d(odd(whole, tmp_path, 4, 5), CaptureOptions())


@pytest.mark.parametrize("samples", [0, 1, 5])
def test_channels_are_those_that_parameters_and_rates_make(whole, tmp_path, samples):
    capture = read_c3d(odd(whole, tmp_path, 18, samples), CaptureOptions())
    assert len(capture.analog) == 6 and capture.analog[0].rate_hz == 1000.0
    assert any("analog channels, the file has 6" in note for note in capture.notes)


@pytest.mark.parametrize(("off", "found"), [(1, "; they are read"), (-1, "; they"), (900, "beyond its end")])
def test_two_entries_that_agree_place_the_data(tmp_path, off, found):
    content = c3d_bytes(standing_points(40, 9), extra=((1, "DATA_START", 2, (), integers([3], INTEL)),))
    layout = check_layout(odd(content, tmp_path, 16, 3 + off))
    assert check_start(content) == 3 and layout.data_block == 3
    assert any(f"the data into block {3 + off}" in note and found in note for note in layout.notes)


@pytest.mark.parametrize("block", [0, 1, 2, 3])
def test_data_that_would_begin_before_the_parameters_end_begin_after_them(whole, tmp_path, block):
    layout = check_layout(odd(whole, tmp_path, 16, block))
    assert layout.data_block == check_start(whole)
    assert any(f"the data into block {block}" in note for note in layout.notes)


@pytest.mark.parametrize("blocks", [0, 1, 255])
def test_a_section_counted_wrong_ends_where_the_data_begin(whole, tmp_path, blocks):
    path = tmp_path / "odd.c3d"
    path.write_bytes(whole[:514] + bytes([blocks]) + whole[515:])
    assert check_layout(path).section.records == check_layout_of(whole, tmp_path).section.records


def check_layout_of(content, tmp_path):
    path = tmp_path / "sound.c3d"
    path.write_bytes(content)
    return check_layout(path)


@pytest.mark.parametrize("processor", [INTEL, DEC, MIPS])
def test_processors_may_be_counted_from_one(tmp_path, processor):
    content = bytearray(c3d_bytes(standing_points(12, 5), processor=processor))
    content[515] -= 83
    assert check_layout_of(content, tmp_path).processor == processor


@pytest.mark.parametrize("block", [0, 1])
def test_parameters_cannot_stand_in_the_header(whole, tmp_path, block):
    path = tmp_path / "odd.c3d"
    path.write_bytes(bytes([block]) + whole[1:])
    with pytest.raises(FileFormatError, match=f"the parameters into block {block}"):
        read_c3d(path, CaptureOptions())


@pytest.mark.parametrize("processor", [INTEL, DEC, MIPS])
@pytest.mark.parametrize(("stored", "stated"), [(None, 0.1), (0.1, -1.0)])
def test_a_scale_of_the_wrong_sign_is_overruled_by_the_size_of_the_file(tmp_path, processor, stored, stated):
    points = np.round(standing_points(40, 9), 1)
    content = bytearray(c3d_bytes(points, scale=stored, processor=processor))
    content[12:16] = floats([stated], processor)
    path = tmp_path / "odd.c3d"
    path.write_bytes(content)
    content = decode(path, check_layout(path))
    np.testing.assert_allclose(content.points, points, rtol=1e-5)
    assert any("fill the file" in note for note in content.notes)


def test_random_bytes_in_the_parameters_are_harmless_or_refused(whole, tmp_path):
    rng = np.random.default_rng(11)
    refused = 0
    for trial in range(60):
        content = bytearray(whole)
        for at in rng.integers(512, (check_start(whole) - 1) * 512, 5):
            content[at] = rng.integers(256)
        path = tmp_path / f"{trial}.c3d"
        path.write_bytes(content)
        try:
            assert check_layout(path).frames == 12
        except FileFormatError:
            refused += 1
    assert 0 < refused < 60
