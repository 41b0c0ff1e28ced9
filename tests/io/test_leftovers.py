"""What a killed process left unfinished is swept by the next; what a living one writes is not."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mbkf.io import leftovers
from mbkf.io.leftovers import remove_held, sweep, sweep_folder, unfinished

HOLD = """
import sys, time
from pathlib import Path
from mbkf.io.leftovers import unfinished
with unfinished(Path(sys.argv[1]), folder=sys.argv[2] == "folder") as path:
    print(path, flush=True)
    time.sleep(60)
"""


@pytest.mark.parametrize("folder", [False, True])
def test_it_is_there_while_it_is_written_and_gone_afterwards(tmp_path, folder):
    target = tmp_path / "walk.c3d"
    with unfinished(target, folder=folder) as path:
        assert path.is_dir() == folder and path.parent == tmp_path
        assert path.name.startswith(".walk-") and path.suffix == ".c3d"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("error", "named"),
    [
        (lambda path: OSError(errno.ENOSPC, "full"), "walk"),
        (lambda path: OSError(errno.ENOSPC, "full", str(path)), "walk"),
        (lambda path: OSError(errno.ENOSPC, "full", os.fsencode(path / "a.c3d")), "walk/a.c3d"),
        (lambda path: OSError(errno.EACCES, "refused", str(path / "a"), None, "b"), "walk/a"),
        (lambda path: OSError(errno.ENOSPC, "full", str(path.with_name("other"))), "other"),
        (lambda path: OSError(errno.ENOENT, "missing"), None),
    ],
)
def test_errors_name_the_target(error, named, tmp_path):
    with pytest.raises(OSError) as raised, unfinished(tmp_path / "walk", folder=True) as path:
        raise error(path)
    assert raised.value.filename == (None if named is None else str(tmp_path / named))
    if named in {"walk", "walk/a"}:
        assert raised.value.filename2 is None


def test_an_unfinished_file_that_cannot_be_made_is_an_error_of_the_target(tmp_path):
    for folder in (False, True):
        with (
            pytest.raises(FileNotFoundError) as raised,
            unfinished(tmp_path / "none" / "a.c3d", folder=folder),
        ):
            pass
        assert raised.value.filename == str(tmp_path / "none" / "a.c3d")


def test_an_error_names_the_place_that_is_to_be_shown(tmp_path):
    with (
        pytest.raises(OSError, match="full") as raised,
        unfinished(tmp_path / "walk", folder=True, shown=tmp_path) as path,
        unfinished(path / "walk.c3d"),
    ):
        raise OSError(errno.ENOSPC, "full")
    assert raised.value.filename == str(tmp_path / "walk.c3d")


def test_what_took_its_place_stays(tmp_path):
    with unfinished(tmp_path / "a") as path:
        path.rename(tmp_path / "a")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX locks")
@pytest.mark.parametrize("kind", ["file", "folder"])
def test_a_killed_process_leaves_it_and_the_next_sweeps_it(tmp_path, kind):
    target = tmp_path / "result"
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(target), kind], stdout=subprocess.PIPE, text=True
    )
    left = tmp_path / Path(process.stdout.readline().strip()).name
    sweep(target)
    assert left.exists()
    process.send_signal(signal.SIGKILL)
    process.communicate()
    sweep(tmp_path / "other")
    assert left.exists()
    with unfinished(target, folder=True) as path:
        assert not left.exists() and path.exists()


def test_without_locks_only_what_is_old_is_swept(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fcntl", None)
    names = [f".result-{digit * 32}" for digit in "ab"]
    for name in names:
        (tmp_path / name).mkdir()
    long_ago = time.time() - leftovers.OLDEST_S - 60.0
    os.utime(tmp_path / names[0], (long_ago, long_ago))
    sweep(tmp_path / "result")
    assert [path.name for path in tmp_path.iterdir()] == [names[1]]


def test_names_of_others_and_links_stay(tmp_path):
    others = [".result-1234", "result-" + "a" * 32, ".result-" + "g" * 32, ".result-" + "a" * 32 + ".txt"]
    for name in others:
        (tmp_path / name).touch()
    (tmp_path / ("." + "result-" + "b" * 32)).symlink_to(tmp_path / others[0])
    sweep(tmp_path / "result")
    assert len(list(tmp_path.iterdir())) == len(others) + 1
    sweep(tmp_path / "nowhere" / "result")


def test_a_process_that_ends_removes_all_that_it_holds(tmp_path):
    with unfinished(tmp_path / "a.c3d") as file, unfinished(tmp_path / "b", folder=True) as folder:
        (folder / "motion.h5").touch()
        remove_held()
        assert not file.exists() and not folder.exists()
    assert leftovers._held == set()


def test_all_that_killed_processes_left_in_a_folder_is_swept(tmp_path):
    kept = [tmp_path / ".hidden", tmp_path / f"walk-{'a' * 32}", tmp_path / f".walk-{'a' * 31}"]
    left = [tmp_path / f".walk-{'b' * 32}.c3d", tmp_path / f".walk 2.x-{'c' * 32}"]
    for path in (*kept, *left):
        path.touch()
    (tmp_path / f".walk-{'d' * 32}").mkdir()
    with unfinished(tmp_path / "other") as living:
        sweep_folder(tmp_path)
        assert set(tmp_path.iterdir()) == {*kept, living}
    sweep_folder(tmp_path / "missing")
