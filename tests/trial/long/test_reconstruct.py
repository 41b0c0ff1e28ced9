"""A walk reconstructed in pieces against the same walk reconstructed whole: with a gap, a restart and steps at borders.

Two plates are loaded across borders of pieces, and all markers are gone around frame 200, which is one, too.
"""

import errno
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.io import leftovers
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.capture_pieces import CapturePieces
from mbkf.io.results import QUANTITIES
from mbkf.io.results_folder import read_reconstruction, read_summary, write_reconstruction
from mbkf.trial.long.pieces import PieceSettings
from mbkf.trial.long.prepared import prepared
from mbkf.trial.long.reconstruct import reconstruct_long
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.synth import synthesise

LENGTHS = PieceSettings(frames=100, margin_s=1.0, look_frames=10_000)
GAP = slice(185, 212)
MERGED = {
    "checks",
    "warnings",
    "verdict",
    "nis",
    "step_seconds_median",
    "step_seconds_p99",
    "realtime_factor",
}
"""Entries of summaries that pieces judge, or that take time."""


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """Three seconds of a walk in a file, and the person."""
    person, made = synthesise("walk", seconds=3.0)
    markers = made.trial.markers
    positions = markers.positions_m.copy()
    positions[GAP] = np.nan
    path = tmp_path_factory.mktemp("walk") / "walk.c3d"
    write_c3d(replace(made.trial, markers=replace(markers, positions_m=positions)), path)
    return path, person


def both_ways(walk, folder, settings):
    """The result whole, and in pieces, each with its summary, from their folders."""
    path, person = walk
    whole = reconstruct(read_capture(path), person, settings=settings)
    write_reconstruction(whole, summarise(whole), folder / "whole")
    pieces = CapturePieces.of(path, LENGTHS.look_frames)
    told = reconstruct_long(pieces, person, folder / "pieces", settings=settings, lengths=LENGTHS)
    assert read_summary(folder / "pieces")["frames"] == told["frames"] == whole.frames
    return [(read_reconstruction(folder / way), read_summary(folder / way)) for way in ("whole", "pieces")]


def assert_equal_results(one, other):
    for name, declared in QUANTITIES.items():
        first, second = getattr(one, name), getattr(other, name)
        if declared.is_text:
            assert name == "warnings" or first == second, name
        elif name != "step_seconds":
            assert (first is None) == (second is None), name
            if first is not None:
                np.testing.assert_allclose(second, first, rtol=0.0, atol=1e-9, err_msg=name)


def assert_equal_numbers(one, other, path=""):
    assert type(one) is type(other), path
    if isinstance(one, dict):
        assert one.keys() == other.keys(), path
        for key in one.keys() - MERGED:
            assert_equal_numbers(one[key], other[key], f"{path}.{key}")
    elif isinstance(one, list):
        assert len(one) == len(other), path
        for k, pair in enumerate(zip(one, other, strict=True)):
            assert_equal_numbers(*pair, f"{path}[{k}]")
    elif isinstance(one, float):
        assert other == pytest.approx(one, rel=1e-9, abs=1e-9), path
    else:
        assert one == other or path == ".run_id", path


def test_smoothed_pieces_are_the_whole(walk, tmp_path):
    hide = (Hidden(("RKNE", "LKNE"), 0.8, 1.3),)
    (whole, told), (pieces, of_pieces) = both_ways(walk, tmp_path, ReconstructSettings(hide=hide))
    assert whole.tracked[GAP.start - 1] and not whole.tracked[GAP].any() and whole.tracked[GAP.stop]
    assert (whole.foot_source[98:102] == 1).any(axis=1).all()
    assert_equal_results(whole, pieces)
    assert_equal_numbers(told, of_pieces)
    restart = f"the filter started anew at frame {GAP.stop}"
    assert restart in pieces.warnings and restart in whole.warnings
    assert pieces.uncorrected == whole.uncorrected and pieces.limb_doubts == whole.limb_doubts


def test_the_causal_filter_goes_on_over_borders_exactly(walk, tmp_path):
    settings = ReconstructSettings(filter="kinematic", smooth=False)
    (whole, _), (pieces, _) = both_ways(walk, tmp_path, settings)
    for name in ("q", "v", "a", "sd_q", "sd_v", "nis"):
        np.testing.assert_array_equal(getattr(pieces, name), getattr(whole, name))
    assert_equal_results(whole, pieces)


def test_an_end_on_the_way_leaves_an_earlier_result(walk, tmp_path, monkeypatch):
    path, person = walk
    settings = ReconstructSettings(filter="kinematic", smooth=False, checks=False)
    source, folder = CapturePieces.of(path, LENGTHS.look_frames), tmp_path / "result"
    reconstruct_long(source, person, folder, settings=settings, lengths=LENGTHS)
    before = {one.name: one.read_bytes() for one in folder.iterdir()}

    def end(stage, done, _):
        if stage == "Assembling" and done > LENGTHS.frames:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reconstruct_long(source, person, folder, settings=settings, lengths=LENGTHS, progress=end)
    assert {one.name: one.read_bytes() for one in folder.iterdir()} == before
    assert [one.name for one in tmp_path.iterdir()] == ["result"]

    with monkeypatch.context() as killed, pytest.raises(KeyboardInterrupt):
        killed.setattr(leftovers, "_remove", lambda _: None)
        reconstruct_long(source, person, folder, settings=settings, lengths=LENGTHS, progress=end)
    assert len(list(tmp_path.iterdir())) == 2
    with replacing_folder(folder):  # as any run into the folder
        assert {one.name: one.read_bytes() for one in folder.iterdir()} == before
    assert [one.name for one in tmp_path.iterdir()] == ["result"]


def test_a_full_disk_is_reported_for_the_folder_of_the_result(walk, tmp_path):
    path, person = walk
    source = CapturePieces.of(path, LENGTHS.look_frames)

    def full(*_):
        raise OSError(errno.ENOSPC, "full")  # as a write of an array, which names no file

    with pytest.raises(OSError, match="full") as stopped:
        reconstruct_long(source, person, tmp_path / "result", lengths=LENGTHS, progress=full)
    assert stopped.value.filename == str(tmp_path / "result")


def test_tables_of_an_earlier_result_do_not_stay(walk, tmp_path):
    path, person = walk
    settings = ReconstructSettings(filter="kinematic", smooth=False, checks=False)
    short = reconstruct(read_capture(path), person, settings=settings)
    write_reconstruction(short, summarise(short), tmp_path / "result")
    source = CapturePieces.of(path, LENGTHS.look_frames)
    reconstruct_long(source, person, tmp_path / "result", settings=settings, lengths=LENGTHS)
    assert sorted(one.name for one in (tmp_path / "result").iterdir()) == ["motion.h5", "summary.json"]


def test_exchanged_names_are_put_right_and_counted(walk, tmp_path):
    path, person = walk
    capture = read_capture(path)
    names, positions = list(capture.markers.names), capture.markers.positions_m.copy()
    a, b = names.index("LKNE"), names.index("LANK")
    positions[20:60, [a, b]] = positions[20:60, [b, a]]
    write_c3d(replace(capture, markers=replace(capture.markers, positions_m=positions)), tmp_path / "x.c3d")
    pages = tmp_path / "pages"
    pages.mkdir()
    source, settings = CapturePieces.of(tmp_path / "x.c3d", 10_000), ReconstructSettings(checks=False)
    found = prepared(source, person, settings, LENGTHS, pages, None)
    assert {frozenset(pair): n for pair, n in found.exchanged.items()} == {frozenset({"LKNE", "LANK"}): 40}
    own = found.inputs.names.index("LKNE")
    np.testing.assert_allclose(found.measured[0:100][:, own], capture.markers.positions_m[:100, a], atol=1e-6)


def test_a_person_who_is_not_there_is_refused(walk, tmp_path):
    path, person = walk
    nobody = replace(
        person, markers=tuple(replace(m, name=f"no {m.name}", aliases=()) for m in person.markers)
    )
    with pytest.raises(NotObservable, match="of the subject's markers"):
        reconstruct_long(CapturePieces.of(path, 10_000), nobody, tmp_path / "result", lengths=LENGTHS)
    assert not any(tmp_path.iterdir())


def test_margins_are_cut_off_all_arrays(walk):
    path, person = walk
    settings = ReconstructSettings(filter="kinematic", smooth=False, checks=False)
    whole = reconstruct(read_capture(path), person, settings=settings)
    cut = whole.part(slice(10, 40))
    assert cut.frames == 30
    np.testing.assert_array_equal(cut.predicted_m, whole.predicted_m[10:40])
    assert cut.plate_names == whole.plate_names
