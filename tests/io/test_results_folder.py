"""The folder of results: complete or absent, never half of it."""

import shutil

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io import results_folder
from mbkf.io.atomic import check_folder
from mbkf.io.hdf5 import run_of
from mbkf.io.quantities import TIME, quantities
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import (
    RESULT_FILES,
    read_reconstruction,
    read_summary,
    write_reconstruction,
)
from mbkf.io.results_h5 import write_h5
from mbkf.io.storage import read_storage
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


def told(folder):
    """The summary without the run's number."""
    return {key: value for key, value in read_summary(folder).items() if key != "run_id"}


def test_six_files_are_written_and_read_back(tmp_path):
    r = made_up()
    folder = write_reconstruction(r, {"trial": "walk"}, tmp_path / "a" / "out")
    assert sorted(path.name for path in folder.iterdir()) == FILES
    assert [path.name for path in folder.parent.iterdir()] == ["out"]
    np.testing.assert_array_equal(read_reconstruction(folder).q, r.q)
    np.testing.assert_array_equal(read_reconstruction(folder / "motion.h5").tau, r.tau)
    assert told(folder) == {"trial": "walk"}


def test_blocks_are_parts_of_the_whole(tmp_path, monkeypatch):
    made = made_up()
    write_reconstruction(made, {}, tmp_path)
    whole = read_reconstruction(tmp_path)
    monkeypatch.setattr(results_folder, "BLOCK", 2)
    blocks = list(results_folder.read_blocks(tmp_path))
    assert sum(one.frames for one in blocks) == whole.frames > blocks[0].frames == 2
    for begin, block in zip(range(0, whole.frames, 2), blocks, strict=True):
        part = whole.part(slice(begin, begin + 2))
        for name, one in quantities(Reconstruction).items():
            np.testing.assert_array_equal(getattr(block, name), getattr(part, name), err_msg=name)
            assert (
                one.is_text
                or getattr(part, name) is None
                or one.axes[0] != TIME
                or len(getattr(part, name)) == block.frames
            )
    assert blocks[0].warnings == whole.warnings


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
    assert told(folder) == expected


def test_an_older_result_is_replaced_and_other_files_stay(tmp_path):
    write_reconstruction(made_up(seed=1), {"run": 1}, tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    r = made_up(seed=2)
    write_reconstruction(r, {"run": 2}, tmp_path)
    np.testing.assert_array_equal(read_reconstruction(tmp_path).q, r.q)
    assert told(tmp_path) == {"run": 2}
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


def test_all_files_of_a_run_carry_its_number(tmp_path):
    folders = [write_reconstruction(made_up(), {}, tmp_path / name) for name in "ab"]
    runs = [read_summary(folder)["run_id"] for folder in folders]
    assert runs[0] != runs[1]
    for folder, run in zip(folders, runs, strict=True):
        assert run_of(folder / "motion.h5") == run
        for table in (*folder.glob("*.mot"), *folder.glob("*.sto")):
            assert read_storage(table).header["run"] == run


@pytest.mark.parametrize("mixed", ["summary.json", "motion.h5"])
def test_files_of_two_runs_are_refused(tmp_path, mixed):
    a, b = (write_reconstruction(made_up(), {}, tmp_path / name) for name in "ab")
    shutil.copy(b / mixed, a / mixed)
    for read in (read_summary, read_reconstruction):
        with pytest.raises(FileFormatError, match="different runs"):
            read(a)
    assert read_reconstruction(a / "motion.h5").frames == made_up().frames


def test_results_without_a_number_are_read(tmp_path):
    """As earlier versions wrote them."""
    folder = write_reconstruction(made_up(), {"trial": "walk"}, tmp_path)
    (folder / "summary.json").write_text('{"trial": "walk"}')
    with pytest.raises(FileFormatError, match="different runs"):
        read_summary(folder)
    write_h5(made_up(), folder / "motion.h5")
    assert read_summary(folder) == {"trial": "walk"}
    assert read_reconstruction(folder).frames == made_up().frames


def test_a_folder_in_the_place_of_a_file_is_refused_and_nothing_changes(tmp_path):
    (tmp_path / "summary.json").mkdir()
    with pytest.raises(FileFormatError, match="a folder stands where a file is needed"):
        write_reconstruction(made_up(), {}, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["summary.json"]
    with pytest.raises(FileFormatError, match="a folder stands where a file is needed"):
        check_folder(tmp_path, RESULT_FILES)


@pytest.mark.parametrize("text", ["[1]", "{", '"a"', "[" * 100_000])
def test_a_damaged_summary_is_refused(tmp_path, text):
    (tmp_path / "summary.json").write_text(text)
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_summary(tmp_path)
