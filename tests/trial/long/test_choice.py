"""Captures that are reconstructed in pieces."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.capture import write_capture
from mbkf.trial.long.choice import long_capture
from tests.motions import capture_of

NAMES = tuple(f"M{k}" for k in range(12))


@pytest.fixture
def made():
    rng = np.random.default_rng(0)
    places = rng.normal(size=(1, len(NAMES), 3)) * 0.3 + [0.0, 0.0, 1.0]
    return capture_of(NAMES, places + 0.01 * rng.normal(size=(40, len(NAMES), 3)))


def test_a_c3d_file_of_more_frames_than_the_bound_is_long(made, tmp_path):
    path = tmp_path / "trial.c3d"
    write_capture(made, path)
    assert long_capture(path) is None
    assert long_capture(path, longer_than=40) is None
    assert long_capture(path, longer_than=39).frames == 40


def test_other_formats_and_captures_with_electromyograms_are_whole(made, tmp_path):
    write_capture(made, tmp_path / "trial.trc")
    assert long_capture(tmp_path / "trial.trc", longer_than=10) is None
    write_capture(made, tmp_path / "trial.c3d")
    (tmp_path / "trial_emg.csv").write_text("time,gastrocnemius_r\n0,0\n0.001,0\n")
    assert long_capture(tmp_path / "trial.c3d", longer_than=10) is None


def test_a_missing_file_is_left_to_the_reader_and_a_broken_one_refused(tmp_path):
    assert long_capture(tmp_path / "no.c3d") is None
    (tmp_path / "broken.c3d").write_bytes(b"\2\x50" + bytes(100))
    with pytest.raises(FileFormatError):
        long_capture(tmp_path / "broken.c3d")
