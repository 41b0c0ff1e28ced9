"""A recorded run leaves a C3D file with the stream's markers and plates, whose causal results are the run's."""

import errno
import os
from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.written import overwriting
from mbkf.stream.run import recording
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.stream.run.recording import WrittenRecording, write_recording
from mbkf.trial.live.recording import MARKERS_FILE
from mbkf.trial.reconstruct import reconstruct
from tests.stream.scripted import SETTINGS, follow, frames_of

pytestmark = pytest.mark.slow

FRAMES = 40


@pytest.fixture(scope="module")
def recorded(tmp_path_factory, capture, subject):
    """A run of some frames, of which one was lost and one came twice, and its recording."""
    folder = tmp_path_factory.mktemp("recorded")
    stream, frames = frames_of(capture)
    script = [*frames[:20], frames[19], *frames[21:FRAMES]]
    outcome = follow(folder / "out", stream, script, subject, record=folder / "walk.c3d")
    return folder, outcome


def test_markers_names_and_plates_are_those_of_the_stream(recorded, capture):
    folder, outcome = recorded
    assert (
        outcome.report["recording"] == str(folder / "walk.c3d")
        and outcome.report["frames_recorded"] == FRAMES
    )
    assert outcome.report["recording_problem"] is None and not (folder / "out" / LOG_FOLDER).exists()
    found = read_capture(folder / "walk.c3d", tare=False)
    expected = np.array(capture.markers.positions_m[:FRAMES])
    expected[20] = np.nan
    assert found.markers.names == capture.markers.names
    np.testing.assert_allclose(found.markers.positions_m, expected, atol=1e-6)
    for one, other in zip(found.plates, capture.plates, strict=True):
        ratio = round(other.rate_hz / capture.markers.rate_hz)
        until = ratio * (FRAMES - 1) + ratio // 2
        np.testing.assert_allclose(one.corners_m, other.corners_m, atol=1e-6)
        np.testing.assert_allclose(one.force_n[:until], other.force_n[:until], atol=1e-3)


def test_the_causal_results_of_the_recording_are_those_of_the_run(recorded, subject):
    folder, _ = recorded
    again = reconstruct(
        read_capture(folder / "walk.c3d", tare=False), subject, settings=replace(SETTINGS, smooth=False)
    )
    found = read_reconstruction(folder / "out")
    for name in ("q", "angles", "predicted_m"):  # the last frame's samples were not all sent
        np.testing.assert_allclose(
            getattr(again, name)[:-1], getattr(found, name)[:-1], atol=1e-6, err_msg=name
        )
    np.testing.assert_allclose(again.foot_wrench[:-1], found.foot_wrench[:-1], atol=1e-2)


def test_points_without_names_are_recorded(tmp_path, capture, subject):
    stream, frames = frames_of(capture, unlabelled=True)
    follow(tmp_path / "out", stream, frames[:5], subject, record=tmp_path / "bare.c3d")
    found = read_capture(tmp_path / "bare.c3d")
    assert all(name.startswith("*") for name in found.markers.names)
    seen = np.sort(found.markers.positions_m[..., 0], axis=1)
    played = np.sort([frame.unlabelled_m[:, 0] for frame in frames[:5]], axis=1)
    np.testing.assert_allclose(seen, played[:, : seen.shape[1]], atol=1e-6)


def test_a_file_that_cannot_be_written_leaves_the_log_which_makes_it_later(
    tmp_path, capture, subject, monkeypatch
):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    stream, frames = frames_of(capture)
    with monkeypatch.context() as patched:
        patched.setattr(recording, "write_c3d", full)
        outcome = follow(tmp_path, stream, frames[:5], subject, record=tmp_path / "walk.c3d")
    assert "space" in outcome.report["recording_problem"] and outcome.summary is not None
    assert (tmp_path / LOG_FOLDER).is_dir() and not (tmp_path / "walk.c3d").exists()
    written = write_recording(tmp_path)
    assert (written.file, written.frames, written.problem) == (tmp_path / "walk.c3d", 5, None)
    assert read_capture(tmp_path / "walk.c3d").markers.frames == 5
    before = (tmp_path / "walk.c3d").stat().st_mtime_ns
    assert "replaces no other one" in str(write_recording(tmp_path).problem)
    assert (tmp_path / "walk.c3d").stat().st_mtime_ns == before
    with overwriting():
        assert write_recording(tmp_path).problem is None


def test_a_damaged_recording_is_a_problem_and_no_recording_is_none(tmp_path):
    assert write_recording(tmp_path) == WrittenRecording()
    (tmp_path / LOG_FOLDER).mkdir()
    (tmp_path / LOG_FOLDER / MARKERS_FILE).write_bytes(b"damaged")
    found = write_recording(tmp_path)
    assert found.problem is not None and found.sentences[0].startswith("the recording could not be written")
