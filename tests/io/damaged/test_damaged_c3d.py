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
    "three points against two, where neither fills the file": word(2, 3) + bytes(512),
    "no POINT:USED and points that do not fill the file": with_bytes(AT[b"USED"], b"USEX") + bytes(512),
    "parameters beyond the file": with_bytes(0, b"\xff"),
    "processor of nobody": with_bytes(515, b"\x07"),
    "65535 analog numbers": word(4, 65535),
    "last frame before the first": word(8, 0),
    "60000 frames in a small file": word(8, 60000),
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


SOUND = {
    "data at block 0": (word(16, 0), "the data into block 0, before its parameters end"),
    "data beyond the file": (word(16, 60000), "the data into block 60000, beyond its end"),
    "a record that points beyond the section": (
        word(AT[b"USED"] + 4, 65535),
        "the record USED points beyond the section; its own length leads to the next",
    ),
    "65535 points": (word(2, 65535), "POINT:USED is 2, the header counts 65535 points; 2 fill the file"),
    "no points against two": (word(2, 0), "POINT:USED is 2, the header counts 0 points; 2 fill the file"),
    "POINT:USED of sixty": (
        word(AT[b"USED"] + 8, 60),
        "POINT:USED is 60, the header counts 2 points; 2 fill",
    ),
    "POINT:USED renamed": (with_bytes(AT[b"USED"], b"USEX"), "POINT:USED is missing"),
    "POINT:USED of 255 dimensions": (with_bytes(AT[b"USED"] + 7, b"\xff"), "USED has no valid type"),
    "POINT:USED of another type": (with_bytes(AT[b"USED"] + 6, b"\x09"), "USED has no valid type"),
    "ANALOG:USED of another type": (
        with_bytes(WHOLE.index(b"USED", AT[b"LABELS"]) + 6, b"\x09"),
        "USED has no valid type",
    ),
    "LABELS of 255 x 255": (with_bytes(AT[b"LABELS"] + 10, b"\xff\xff"), "LABELS is longer than its record"),
    "a name that is no text": (with_bytes(AT[b"RATE"] + 1, b"\x02"), "the name at byte"),
    "a parameter of no group": (
        c3d_bytes(POINTS, ANALOGS, extra=(*plate(), (9, "SCALE", 4, (), floats([5.0], INTEL)))),
        "parameter SCALE belongs to no group",
    ),
    "a last record that points beyond the section": (
        word(WHOLE.index(b"ORIGIN") + 6, 60000),
        "the record ORIGIN points beyond the section",
    ),
}


@pytest.mark.parametrize("case", SOUND)
def test_what_is_sound_beside_damaged_parameters_is_read(tmp_path, case):
    content, note = SOUND[case]
    (tmp_path / "a.c3d").write_bytes(content)
    found = read_capture(tmp_path / "a.c3d")
    np.testing.assert_allclose(found.markers.positions_m, POINTS * 1e-3, atol=1e-6)
    assert found.plates[0].force_n[:, 2] == pytest.approx(700.0) and found.markers.rate_hz == 100.0
    assert any(note in one for one in found.notes)


def test_points_are_read_without_the_parameters_behind_a_record_that_is_stated_to_be_the_last(tmp_path):
    (tmp_path / "a.c3d").write_bytes(word(AT[b"USED"] + 4, 0))
    found = read_capture(tmp_path / "a.c3d")
    np.testing.assert_allclose(found.markers.positions_m, POINTS * 1e-3, atol=1e-6)
    assert found.markers.names == ("*0", "*1") and found.plates == found.analog == ()
    for note in ("damaged parameters", "have no label", "no length unit", "analog channels are left out"):
        assert any(note in one for one in found.notes)


@pytest.mark.parametrize(
    ("at", "left_out"),
    [
        (WHOLE.index(b"SCALE", AT[b"SCALE"] + 20), "analog channels are left out"),
        (WHOLE.index(b"OFFSET"), "analog channels are left out"),
        (WHOLE.index(b"ORIGIN"), "force plates are left out"),
        (WHOLE.index(b"CORNERS"), "force plates are left out"),
    ],
)
def test_forces_are_left_out_where_damage_took_the_parameters_that_scale_them(tmp_path, at, left_out):
    """The type of a record stands behind its name and the distance to the next one."""
    name_ends = at + next(k for k in range(20) if not WHOLE[at + k : at + k + 1].isalpha())
    (tmp_path / "a.c3d").write_bytes(with_bytes(name_ends + 2, b"\x09"))
    found = read_capture(tmp_path / "a.c3d")
    assert found.plates == () and any(left_out in note for note in found.notes)
    np.testing.assert_allclose(found.markers.positions_m, POINTS * 1e-3, atol=1e-6)


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
