"""The folder of a run keeps every log until its results are written."""

import errno
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from mbkf.io.frame_log import read_frame_log
from mbkf.io.results_folder import read_reconstruction
from mbkf.stream.run.folder import LOG_FOLDER, drop_log, write_results
from mbkf.stream.run.report import ReportFile
from mbkf.trial.live.log import FRAMES_FILE, PLATES_FILE
from tests.stream.scripted import follow, frames_of

pytestmark = pytest.mark.slow


def test_a_log_that_was_left_behind_is_set_aside(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    for count in (40, 50, 60):
        follow(tmp_path, stream, frames[:count], subject, keep_log=True)
    assert sorted(path.name for path in tmp_path.glob(f"{LOG_FOLDER}*")) == [
        LOG_FOLDER,
        f"{LOG_FOLDER}-1",
        f"{LOG_FOLDER}-2",
    ]
    drop_log(tmp_path)
    (tmp_path / f"{LOG_FOLDER}-1").rename(tmp_path / LOG_FOLDER)
    written = write_results(tmp_path, ("recovered",))
    assert (written.summary["frames"], written.problem, written.left_out) == (40, None, ())
    assert read_reconstruction(tmp_path).frames == 40


@pytest.mark.parametrize(
    "place", ["mbkf.stream.run.report.replacing", "mbkf.stream.run.folder.write_subject"]
)
def test_a_run_that_cannot_begin_leaves_the_earlier_report_and_no_log(
    place, tmp_path, capture, subject, monkeypatch
):
    stream, frames = frames_of(capture)
    follow(tmp_path, stream, frames[:40], subject)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(place, full)
    with pytest.raises(OSError, match="space"):
        follow(tmp_path, stream, frames[:40], subject)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no device that is full")
@pytest.mark.parametrize("results", [True, False])
def test_a_last_report_that_cannot_be_written_is_named_and_hides_nothing(
    results, tmp_path, capture, subject, monkeypatch
):
    stream, frames = frames_of(capture)
    true = ReportFile.write

    def on_a_full_disk(report, content, last=False):
        if last:
            report._path = Path("/dev/full")
        true(report, content, last)

    monkeypatch.setattr(ReportFile, "write", on_a_full_disk)
    if not results:
        monkeypatch.setattr("mbkf.stream.run.folder.summarise", None)
    outcome = follow(tmp_path, stream, frames[:40], subject)
    assert "/dev/full" in outcome.unreported and (outcome.problem is None) is results


def test_without_a_log_it_says_why_there_are_no_results(tmp_path):
    written = write_results(tmp_path, ())
    assert written.summary is None
    assert "no such file" in written.problem


@pytest.fixture(scope="module")
def finished(tmp_path_factory, capture, subject):
    """The folder of a run of 40 frames that kept its log."""
    folder = tmp_path_factory.mktemp("finished")
    stream, frames = frames_of(capture)
    follow(folder, stream, frames[:40], subject, keep_log=True)
    return folder


@pytest.mark.parametrize("kept", [1, 2, 3, 20, 39])
def test_a_power_cut_costs_the_rows_from_there_on(tmp_path, finished, kept):
    """The end of both files is zero, as a file system leaves what never reached the disk."""
    shutil.copytree(finished, tmp_path, dirs_exist_ok=True)
    whole = read_reconstruction(finished)
    for name, at in ((FRAMES_FILE, kept), (PLATES_FILE, 10 * kept)):
        cut_off(tmp_path / LOG_FOLDER / name, at)
    written = write_results(tmp_path, ())
    assert written.problem is None
    assert [sentence.split()[0] for sentence in written.left_out] == [str(40 - kept), str(396 - 10 * kept)]
    found = read_reconstruction(tmp_path)
    assert found.frames == kept
    np.testing.assert_array_equal(found.q, whole.q[:kept])
    assert any("left out" in warning for warning in found.warnings)


def test_without_readable_plates_the_motion_is_recovered(tmp_path, finished):
    shutil.copytree(finished, tmp_path, dirs_exist_ok=True)
    whole = read_reconstruction(finished)
    (tmp_path / LOG_FOLDER / PLATES_FILE).write_bytes(bytes(1000))
    written = write_results(tmp_path, ())
    assert written.problem is None
    assert "plates.log" in written.left_out[0]
    np.testing.assert_array_equal(read_reconstruction(tmp_path).q, whole.q)


def test_an_unforeseen_error_leaves_the_log_and_is_told(tmp_path, capture, subject, monkeypatch):
    stream, frames = frames_of(capture)

    def fail(*_):
        raise ZeroDivisionError("by nought")

    monkeypatch.setattr("mbkf.stream.run.folder.summarise", fail)
    outcome = follow(tmp_path, stream, frames[:40], subject)
    assert outcome.problem == "an unforeseen ZeroDivisionError: by nought"
    assert (tmp_path / LOG_FOLDER / FRAMES_FILE).is_file()


def cut_off(path, rows):
    """Nought in place of all that follows so many rows."""
    log, content = read_frame_log(path), path.read_bytes()
    tail = (len(log.rows) - rows) * (log.rows.dtype.itemsize + 4)
    path.write_bytes(content[: len(content) - tail] + bytes(tail))
