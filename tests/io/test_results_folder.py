"""The folder of results: complete or absent, never half of it."""

import json

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io import results_folder
from mbkf.io.results_folder import (
    read_reconstruction,
    read_summary,
    write_reconstruction,
)
from tests.io.reconstructions import made_up

FILES = [
    "angles.mot",
    "angles_lab.mot",
    "markers.trc",
    "motion.h5",
    "reactions.mot",
    "summary.json",
    "torques.sto",
]


def test_six_files_are_written_and_read_back(tmp_path):
    r = made_up()
    folder = write_reconstruction(r, {"trial": "walk"}, tmp_path / "a" / "out")
    assert sorted(path.name for path in folder.iterdir()) == FILES
    assert [path.name for path in folder.parent.iterdir()] == ["out"]
    np.testing.assert_array_equal(read_reconstruction(folder).q, r.q)
    np.testing.assert_array_equal(read_reconstruction(folder / "motion.h5").tau, r.tau)
    assert read_summary(folder) == {"trial": "walk"}


def test_the_summary_holds_no_nan_and_only_plain_data(tmp_path):
    summary = {"a": float("nan"), "b": [np.float64(1.5), np.inf], "c": {"d": np.int64(3)}, "e": (True, None),
               "f": np.array([1.0, np.nan]), "g": tmp_path}  # fmt: skip
    folder = write_reconstruction(made_up(), summary, tmp_path / "out")
    expected = {
        "a": None,
        "b": [1.5, None],
        "c": {"d": 3},
        "e": [True, None],
        "f": [1.0, None],
        "g": str(tmp_path),
    }
    assert json.loads((folder / "summary.json").read_text()) == expected


def test_an_older_result_is_replaced_and_other_files_stay(tmp_path):
    write_reconstruction(made_up(seed=1), {"run": 1}, tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    r = made_up(seed=2)
    write_reconstruction(r, {"run": 2}, tmp_path)
    np.testing.assert_array_equal(read_reconstruction(tmp_path).q, r.q)
    assert read_summary(tmp_path) == {"run": 2}
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_failure_leaves_nothing_behind(tmp_path, monkeypatch):
    def fail(*_):
        raise OSError("disk full")

    monkeypatch.setattr(results_folder, "write_opensim", fail)
    with pytest.raises(OSError, match="disk full"):
        write_reconstruction(made_up(), {}, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_way_is_refused(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(FileFormatError, match="a file stands where a folder is needed"):
        write_reconstruction(made_up(), {}, tmp_path / "out")
    with pytest.raises(FileFormatError, match="name another folder"):
        write_reconstruction(made_up(), {}, tmp_path / "out" / "deeper")


def test_missing_results_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match=r"no motion\.h5"):
        read_reconstruction(tmp_path)
    with pytest.raises(FileFormatError, match="no such file"):
        read_reconstruction(tmp_path / "nowhere")
    with pytest.raises(FileFormatError, match=r"summary\.json"):
        read_summary(tmp_path)
