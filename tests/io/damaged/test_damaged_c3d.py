"""Damaged C3D files, byte by byte: parameters renamed, retyped, resized, absurd counts, wrong strides, files cut."""

import struct

import numpy as np
import pytest

from mbkf.io.c3d import read_c3d
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_bytes import INTEL, c3d_bytes, floats, integers
from tests.io.damaged.refusal import MOST_BYTES, refusal

POINTS = np.random.default_rng(1).uniform(100.0, 1500.0, (4, 2, 3))
CORNERS = np.array([[300.0, 300.0, 0.0], [-300.0, 300.0, 0.0], [-300.0, -300.0, 0.0], [300.0, -300.0, 0.0]])
ANALOGS = np.tile([0.0, 0.0, -700.0, 0.0, 0.0, 0.0], (4, 2, 1))


def plate(**changed):
    own = {
        "USED": (2, (), integers([1], INTEL)), "TYPE": (2, (1,), integers([2], INTEL)),
        "CHANNEL": (2, (6, 1), integers(np.arange(1, 7), INTEL)),
        "CORNERS": (4, (3, 4, 1), floats(CORNERS[[1, 0, 3, 2]], INTEL)),
        "ORIGIN": (4, (3, 1), floats([0.0, 0.0, -40.0], INTEL)),
    }  # fmt: skip
    return tuple((4, name, *value) for name, value in (own | changed).items())


def made(**options):
    return c3d_bytes(POINTS, ANALOGS, extra=plate(**options.pop("plate", {})), **options)


WHOLE = made()
AT = {
    name: WHOLE.index(name)
    for name in (b"USED", b"SCALE", b"RATE", b"LABELS", b"UNITS", b"CORNERS", b"CHANNEL")
}


def with_bytes(at, new):
    return WHOLE[:at] + new + WHOLE[at + len(new) :]


def word(at, value):
    return with_bytes(at, struct.pack("<H", value))


def test_the_undamaged_file_is_read_and_small(tmp_path):
    assert len(WHOLE) <= MOST_BYTES
    (tmp_path / "a.c3d").write_bytes(WHOLE)
    found = read_capture(tmp_path / "a.c3d")
    np.testing.assert_allclose(found.markers.positions_m, POINTS * 1e-3, atol=1e-6)
    assert found.plates[0].force_n[:, 2] == pytest.approx(700.0)


CASES = {
    "empty": b"",
    "folder": None,
    "one byte": b"\x02",
    "text": b"PathFileType\t4\n" * 40,
    "zeros": bytes(1024),
    "only a header": WHOLE[:512],
    "cut in the parameters": WHOLE[:900],
    "cut in the data": WHOLE[:-600],
    "key of another format": with_bytes(1, b"\x51"),
    "parameters at block 0": with_bytes(0, b"\x00"),
    "parameters beyond the file": with_bytes(0, b"\xff"),
    "processor of nobody": with_bytes(515, b"\x07"),
    "65535 points": word(2, 65535),
    "no points against two": word(2, 0),
    "65535 analog numbers": word(4, 65535),
    "last frame before the first": word(8, 0),
    "60000 frames in a small file": word(8, 60000),
    "data at block 0": word(16, 0),
    "data beyond the file": word(16, 60000),
    "POINT:USED renamed": with_bytes(AT[b"USED"], b"USEX"),
    "POINT:USED of 255 dimensions": with_bytes(AT[b"USED"] + 7, b"\xff"),
    "POINT:USED of another type": with_bytes(AT[b"USED"] + 6, b"\x09"),
    "next parameter before this one": word(AT[b"USED"] + 4, 0),
    "next parameter beyond the file": word(AT[b"USED"] + 4, 65535),
    "LABELS of 255 x 255": with_bytes(AT[b"LABELS"] + 10, b"\xff\xff"),
    "POINT:RATE not a number": c3d_bytes(POINTS, rate_hz=float("nan")),
    "POINT:RATE negative": c3d_bytes(POINTS, rate_hz=-100.0),
    "POINT:RATE of 1e9 Hz": c3d_bytes(POINTS, rate_hz=1e9),
    "UNITS of nobody": with_bytes(AT[b"UNITS"] + 10, b"??"),
}

UNREADABLE = {
    "force of 1e7 N": c3d_bytes(POINTS, ANALOGS * 1e5, extra=plate()),
    "force not a number": c3d_bytes(POINTS, ANALOGS * np.nan, extra=plate()),
    "plate of type 99": made(plate={"TYPE": (2, (1,), integers([99], INTEL))}),
    "channels of other plates": made(plate={"CHANNEL": (2, (6, 1), integers(np.arange(2000, 2006), INTEL))}),
    "corners in a point": made(plate={"CORNERS": (4, (3, 4, 1), floats(np.zeros(12), INTEL))}),
    "corners not numbers": made(plate={"CORNERS": (4, (3, 4, 1), floats(np.full(12, np.nan), INTEL))}),
    "corners 1e9 m away": made(
        plate={"CORNERS": (4, (3, 4, 1), floats(CORNERS[[1, 0, 3, 2]] + 1e12, INTEL))}
    ),
    "corners 2 km away": made(plate={"CORNERS": (4, (3, 4, 1), floats(CORNERS[[1, 0, 3, 2]] + 2e6, INTEL))}),
    "corners as texts": made(plate={"CORNERS": (-1, (12,), b"x" * 12)}),
}


@pytest.mark.parametrize("case", CASES)
def test_damage_is_refused(tmp_path, case):
    refusal(read_capture, tmp_path / "a.c3d", CASES[case])


@pytest.mark.parametrize("case", UNREADABLE)
def test_a_plate_that_cannot_be_read_is_left_out_and_named(tmp_path, case):
    (tmp_path / "a.c3d").write_bytes(UNREADABLE[case])
    found = read_capture(tmp_path / "a.c3d")
    np.testing.assert_allclose(found.markers.positions_m, POINTS * 1e-3, atol=1e-6)
    assert found.plates == () and list(found.plates_left_out) == ["1"]
    assert [note for note in found.notes if note.startswith("force plate 1 is left out: ")]


@pytest.mark.parametrize(
    ("content", "note"),
    [
        (c3d_bytes(POINTS * 1e6), "more than 1000 m away"),
        (made(plate={"ORIGIN": (4, (3, 1), floats([0.0, 0.0, 40.0], INTEL))}), "opposite sign"),
        (made(plate={"ORIGIN": (4, (3, 1), floats([0.0, 0.0, -40000.0], INTEL))}), "40 m below"),
        (
            made(plate={"CHANNEL": (2, (6, 1), integers([-1] * 6, INTEL))}),
            "force plate 1 is left out: no analog",
        ),
        (
            made(plate={"USED": (2, (), integers([30000], INTEL))}),
            "29999 force plates are left out (2, 3, 4, 5, 6, 7 …): no analog channels",
        ),
    ],
    ids=["far points", "sign of ORIGIN", "depth of ORIGIN", "channel -1", "30000 plates"],
)
def test_what_is_read_nevertheless_is_told(tmp_path, content, note):
    (tmp_path / "a.c3d").write_bytes(content)
    notes = read_capture(tmp_path / "a.c3d", unit="mm").notes
    assert any(note in one for one in notes) and len(notes) < 10


@pytest.mark.parametrize("at", range(0, 512, 7))
def test_no_byte_of_the_header_does_harm(tmp_path, at):
    path = tmp_path / "a.c3d"
    for value in (0, 1, 0x7F, 0x80, 0xFF):
        path.write_bytes(with_bytes(at, bytes([value])))
        try:
            found = read_c3d(path, CaptureOptions())
        except Exception as error:  # whatever it is, it has to be our own
            assert type(error).__module__ == "mbkf.errors" and path.name in str(error)
        else:
            assert found.markers.positions_m.size <= 4 * 255 * 3
