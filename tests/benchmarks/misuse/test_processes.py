"""Processes are signalled, and what they leave is judged; closed outputs and clashes are told."""

import signal
import sys

import pytest

from benchmarks.misuse.calls import Ending
from benchmarks.misuse.cases import Case
from benchmarks.misuse.processes import Old, _clash, closed, signalled
from benchmarks.misuse.world import INPUTS
from mbkf.conventions import data_folder

SHOW = Case("protocol show", "{protocol} --no-browser --out {OUT}", "new.html")


@pytest.fixture
def world(tmp_path):
    folder = tmp_path / "world"
    folder.mkdir()
    (folder / INPUTS["protocol"]).write_bytes((data_folder("markers") / "reference36.toml").read_bytes())
    return folder


@pytest.fixture
def old(tmp_path):
    folder = tmp_path / "old"
    folder.mkdir()
    return Old(folder, 0.0)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_killed_command_finds_nothing_in_its_way(tmp_path, world, old):
    found = signalled(SHOW, signal.SIGKILL, 0.0, tmp_path / "run", world=world, old=old)
    assert found.wrong == ""


def test_a_torn_file_and_a_double_refusal_are_clashes(tmp_path):
    refused, done = Ending(2, "", "mbkf: error: busy", 1.0, 0.0), Ending(0, "", "", 1.0, 0.0)
    assert _clash([done, refused], tmp_path) == []
    assert _clash([refused, refused], tmp_path) == ["none was written"]
    (tmp_path / "a.html").write_text("<html>")
    assert len(_clash([done, done], tmp_path)) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_closed_and_full_outputs_end_without_a_traceback(tmp_path, world):
    assert closed(Case("protocol list", ""), world, tmp_path / "out") == []
