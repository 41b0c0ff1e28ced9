"""The truth of a synthetic trial is found beside it, and only for the trials it belongs to."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.truth import Truth, write_truth
from mbkf.trial.results.truth import FILE_NAME, truth_beside


@pytest.fixture
def folder(tmp_path):
    frames, nq, nv, names = 4, 3, 2, ("A",)
    write_truth(
        Truth(
            times_s=np.arange(frames) / 100.0,
            q=np.ones((frames, nq)),
            v=np.zeros((frames, nv)),
            a=np.zeros((frames, nv)),
            tau=np.zeros((frames, nv)),
            foot_wrench=np.zeros((frames, 2, 6)),
            centre_of_pressure=np.zeros((frames, 2, 3)),
            marker_names=names,
            markers_m=np.zeros((frames, 1, 3)),
            dof_names=("x", "y"),
        ),
        tmp_path / FILE_NAME,
    )
    return tmp_path


@pytest.mark.parametrize("name", ["trial.c3d", "raw.c3d", "trial.trc"])
def test_trials_have_the_truth_of_their_folder(name, folder):
    truth = truth_beside(folder / name)
    assert truth is not None
    assert truth.q.shape == (4, 3)
    assert truth_beside(str(folder / name)) is not None


@pytest.mark.parametrize("name", ["static.c3d", "walk.c3d", "below/trial.c3d"])
def test_other_captures_have_none(name, folder):
    assert truth_beside(folder / name) is None


def test_no_truth_where_none_lies(tmp_path):
    assert truth_beside(tmp_path / "trial.c3d") is None


def test_a_damaged_truth_is_named(folder):
    (folder / FILE_NAME).write_bytes(b"broken")
    with pytest.raises(FileFormatError, match=FILE_NAME):
        truth_beside(folder / "trial.c3d")
