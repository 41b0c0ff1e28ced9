"""A C3D file read in pieces against the file read whole."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.capture_pieces import CapturePieces, spread_stretches
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from tests.dynamics import trial

NOISY = CaptureSettings(offset_n=(15.0, 25.0))


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A squat with plates at ten times the cameras' rate, which have offsets, from frame 31 on."""
    made = trial("jump")
    capture = synthesise_capture(made.subject, made.motion, NOISY, seed=1).trial
    later = [replace(plate, start_time_s=0.3) for plate in capture.plates]
    capture = replace(capture, markers=replace(capture.markers, start_time_s=0.3), plates=tuple(later))
    found = tmp_path_factory.mktemp("pieces") / "jump.c3d"
    write_c3d(capture, found)
    return found


@pytest.mark.parametrize("options", [{}, {"axes": "-y,x,z"}, {"unit": "cm"}], ids=["plain", "turned", "cm"])
def test_pieces_are_parts_of_the_whole(path, options):
    if "unit" in options:
        options = {**options, "axes": "x,y,z"}
    whole = read_capture(path, **options)
    pieces = CapturePieces.of(path, 10_000, **options)
    assert pieces.frames == whole.markers.frames and pieces.keeps_vertical
    assert pieces.look.notes == whole.notes
    samples = round(whole.plates[0].rate_hz / whole.markers.rate_hz)
    for first, after in ((0, 20), (20, 57), (57, pieces.frames)):
        part = pieces.piece(first, after)
        np.testing.assert_array_equal(part.markers.positions_m, whole.markers.positions_m[first:after])
        assert part.markers.start_time_s == pytest.approx(whole.markers.times_s[first], abs=1e-12)
        assert (part.axes, part.axes_source, part.notes) == (whole.axes, whole.axes_source, ())
        for own, plate in zip(part.plates, whole.plates, strict=True):
            assert own.offset.tolist() == plate.offset.tolist() and plate.offset.any()
            frames = slice(samples * first, samples * after)
            for name in ("force_n", "moment_nm", "centre_of_pressure_m"):
                np.testing.assert_array_equal(getattr(own, name), getattr(plate, name)[frames])


def test_axes_that_contradict_the_vertical_are_refused(path):
    with pytest.raises(InvalidInput, match="contradicts"):
        CapturePieces.of(path, 48, up="y", axes="x,y,z")


def test_a_look_decides_by_stretches_spread_over_the_trial(path):
    look = CapturePieces.of(path, 48).look
    whole = read_capture(path)
    assert look.markers.frames == 48 and len(CapturePieces.of(path, 48).look_frames) == 48
    np.testing.assert_array_equal(look.markers.positions_m[-4:], whole.markers.positions_m[-4:])
    assert [plate.name for plate in look.plates] == [plate.name for plate in whole.plates]


def test_a_plate_that_cannot_be_read_in_a_piece_is_not_recorded_there(path, tmp_path):
    whole = read_capture(path)
    first, second = whole.plates
    force_n = first.force_n.copy()
    samples = round(first.rate_hz / whole.markers.rate_hz)
    force_n[samples * 20] = np.nan
    write_c3d(replace(whole, plates=(replace(first, force_n=force_n), second)), tmp_path / "hole.c3d")
    pieces = CapturePieces.of(tmp_path / "hole.c3d", 48)
    assert [plate.name for plate in pieces.look.plates] == ["1", "2"]
    holed, other = pieces.piece(15, 40).plates
    assert (holed.name, holed.start_time_s) == ("1", pytest.approx(whole.markers.times_s[15]))
    assert holed.force_n.shape == (samples * 25, 3) and np.isnan(holed.force_n).all()
    assert (
        other.name == "2" and other.force_n.shape == holed.force_n.shape and np.isfinite(other.force_n).all()
    )
    assert np.isfinite(pieces.piece(21, 40).plates[0].force_n).all()


def test_samples_beyond_any_laboratory_are_remarked_on_where_they_are(path, tmp_path):
    whole = read_capture(path)
    positions_m = whole.markers.positions_m.copy()
    positions_m[[0, 20], 0] = 2000.0
    write_c3d(replace(whole, markers=replace(whole.markers, positions_m=positions_m)), tmp_path / "far.c3d")
    pieces = CapturePieces.of(tmp_path / "far.c3d", 48)
    assert not any("taken as missing" in note for note in pieces.look.notes)
    assert np.isnan(pieces.look.markers.positions_m[0, 0]).all()
    (note,) = pieces.piece(15, 40).notes
    assert note.startswith("1 samples lie more than 1000 m away")
    assert pieces.piece(21, 40).notes == ()


def test_stretches_are_spread_evenly_and_a_short_trial_is_one():
    assert spread_stretches(1000, 30, 3) == [(0, 10), (495, 505), (990, 1000)]
    assert spread_stretches(30, 30, 3) == [(0, 30)]
    assert spread_stretches(50, 2, 3) == [(0, 50)]


def test_axes_that_turn_the_vertical_are_known(path):
    pieces = CapturePieces.of(path, 10_000)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    assert not pieces.turned(turn).keeps_vertical
