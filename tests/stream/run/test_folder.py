"""The folder of a run keeps every log until its results are written."""

import pytest

from mbkf.io.results_folder import read_reconstruction
from mbkf.stream.run.folder import LOG_FOLDER, drop_log, write_results
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
    summary, problem = write_results(tmp_path, ("recovered",))
    assert (summary["frames"], problem) == (40, None)
    assert read_reconstruction(tmp_path).frames == 40


def test_without_a_log_it_says_why_there_are_no_results(tmp_path):
    summary, problem = write_results(tmp_path, ())
    assert summary is None
    assert "no such file" in problem
