"""A folder is replaced as one: every state that another process can see is the old one or the new one."""

import errno
import os
import subprocess
import sys
import threading

import pytest

from mbkf.errors import FileFormatError, ProtectedFile
from mbkf.io import atomic_folder
from mbkf.io.atomic_folder import replacing_beside, replacing_folder
from mbkf.io.written import OVERWRITE_VARIABLE, overwriting

NAMES = ("a.txt", "b.txt", "last.txt")


@pytest.fixture(autouse=True)
def of_anyone():
    """Replaces whatever stands there; tests/io/test_written.py is about files of others."""
    with overwriting():
        yield


def write(folder, text, names=NAMES):
    with replacing_folder(folder, last="last.txt") as partial:
        for name in names:
            (partial / name).write_text(text)


def contents(folder):
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file()}


@pytest.fixture(params=["as one", "one by one", "current", "not exchanged"])
def way(request, tmp_path, monkeypatch):
    """A folder that holds an old result, and every way in which it may have to be replaced."""
    target = tmp_path / "result"
    write(target, "old")
    if request.param == "one by one":
        monkeypatch.setattr(atomic_folder, "_can_be_renamed", lambda target: False)
    if request.param == "current":
        monkeypatch.chdir(target)
    if request.param == "not exchanged":
        monkeypatch.setattr(atomic_folder, "_exchange", lambda first, second: False)
    return target


def test_new_files_take_the_place_of_the_old_and_others_stay(way, tmp_path):
    (way / "mine").mkdir()
    (way / "mine" / "note.md").write_text("mine")
    (way / "other.txt").write_text("other")
    (way / "link").symlink_to("other.txt")
    write(way, "new")
    assert contents(way) == {**dict.fromkeys(NAMES, "new"), "other.txt": "other", "link": "other"}
    assert (way / "mine" / "note.md").read_text() == "mine" and (way / "link").is_symlink()
    assert [path.name for path in tmp_path.iterdir()] == ["result"]
    assert not [path for path in way.iterdir() if path.name.startswith(".")]


def test_a_failure_changes_nothing(way, tmp_path):
    with pytest.raises(ValueError, match="halfway"), replacing_folder(way) as partial:
        (partial / "a.txt").write_text("half")
        raise ValueError("halfway")
    assert contents(way) == dict.fromkeys(NAMES, "old")
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_a_folder_where_a_file_is_to_be_is_refused(way):
    (way / "c.txt").mkdir()
    with pytest.raises(FileFormatError, match="a folder stands where a file is needed"):
        write(way, "new", ("a.txt", "c.txt"))
    assert contents(way) == dict.fromkeys(NAMES, "old")


def test_it_is_made_where_missing(tmp_path):
    write(tmp_path / "deep" / "result", "new")
    assert contents(tmp_path / "deep" / "result") == dict.fromkeys(NAMES, "new")
    with pytest.raises(FileFormatError, match="a file stands where a folder is needed"):
        write(tmp_path / "deep" / "result" / "a.txt", "new")


def test_a_link_to_a_folder_stays_a_link(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "result").symlink_to("elsewhere")
    write(tmp_path / "result", "new")
    assert (tmp_path / "result").is_symlink()
    assert contents(tmp_path / "elsewhere") == dict.fromkeys(NAMES, "new")


def test_permissions_stay(tmp_path):
    write(tmp_path / "result", "old")
    (tmp_path / "result").chmod(0o750)
    write(tmp_path / "result", "new")
    assert (tmp_path / "result").stat().st_mode & 0o777 == 0o750


@pytest.mark.skipif(sys.platform != "linux", reason="needs Linux's exchange of names")
def test_whoever_reads_meanwhile_sees_one_run(tmp_path):
    """A folder opened once shows files of one run only, and there is one to be opened at every instant."""
    target = tmp_path / "result"
    write(target, "0")
    seen, done = [], threading.Event()

    def look():
        while not done.is_set():
            files = [os.open(target, os.O_RDONLY)]
            try:
                files += [os.open(name, os.O_RDONLY, dir_fd=files[0]) for name in NAMES]
                seen.append({os.read(file, 10) for file in files[1:]})
            except FileNotFoundError:
                pass  # that one was replaced meanwhile, and is removed
            finally:
                for file in files:
                    os.close(file)

    reader = threading.Thread(target=look)
    reader.start()
    for run in range(1, 60):
        write(target, str(run))
    done.set()
    reader.join()
    assert len(seen) > 20 and all(len(texts) == 1 for texts in seen)


KILLED = """
import os, signal, sys
from mbkf.io.atomic_folder import replacing_folder
target, at = sys.argv[1], int(sys.argv[2])
count = 0
def step(event, args):
    global count
    if event.startswith(("os.", "ctypes.dlsym", "open")):
        count += 1
        if count == at:
            os.kill(os.getpid(), signal.SIGKILL)
sys.addaudithook(step)
with replacing_folder(target, last="last.txt") as partial:
    for name in ("a.txt", "b.txt", "last.txt"):
        (partial / name).write_text("new")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="needs Linux's exchange of names")
def test_a_kill_at_any_step_leaves_the_old_or_the_new(tmp_path):
    target, seen = tmp_path / "result", []
    for at in range(1, 500):
        write(target, "old")
        (target / "mine.txt").write_text("mine")
        done = subprocess.run([sys.executable, "-c", KILLED, str(target), str(at)], check=False)
        found = contents(target)
        assert found.pop("mine.txt") == "mine"
        assert set(found) == set(NAMES) and len(set(found.values())) == 1, (at, found)
        seen.append(found["a.txt"])
        if done.returncode == 0:
            break
    assert seen == sorted(seen, reverse=True) and set(seen) == {"old", "new"}
    write(target, "next")
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_a_folder_that_is_a_link_to_itself_is_an_error_of_the_disk(tmp_path):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    with pytest.raises(OSError, match="loop"), replacing_folder(loop) as partial:
        (partial / "a.txt").write_text("new")
    assert [path.name for path in tmp_path.iterdir()] == ["loop"]


PAIR = ("walk.c3d", "walk.json")


def write_pair(folder, text):
    with replacing_beside(folder / PAIR[0]) as partial:
        for name in PAIR:
            (partial / name).write_text(text)


def pair(folder):
    return [(folder / name).read_text() if (folder / name).exists() else None for name in PAIR]


def test_files_beside_each_other_take_their_places_together(tmp_path):
    (tmp_path / "other.c3d").write_text("raw")
    for text in ("first", "second"):
        write_pair(tmp_path, text)
        assert pair(tmp_path) == [text, text]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other.c3d", *PAIR]


@pytest.mark.parametrize("exchange", [True, False])
@pytest.mark.parametrize("there", [[], ["walk.c3d"], ["walk.json"], ["walk.c3d", "walk.json"]])
def test_if_one_cannot_take_its_place_the_others_are_moved_back(there, exchange, tmp_path, monkeypatch):
    for name in there:
        (tmp_path / name).write_text("old")
    before = pair(tmp_path)
    true = atomic_folder._take_place

    def fails(new, target):
        if target.name == PAIR[1]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return true(new, target)

    monkeypatch.setattr(atomic_folder, "_take_place", fails)
    if not exchange:
        monkeypatch.setattr(atomic_folder, "_exchange", lambda *_: False)
    with pytest.raises(OSError, match="space"):
        write_pair(tmp_path, "new")
    if exchange or PAIR[0] not in there:
        assert pair(tmp_path) == before
    assert not list(tmp_path.glob(".*"))


def test_an_error_while_they_are_written_leaves_the_old_ones_and_names_the_file(tmp_path):
    write_pair(tmp_path, "old")
    with pytest.raises(OSError, match="full") as raised, replacing_beside(tmp_path / PAIR[0]) as partial:
        (partial / PAIR[0]).write_text("new")
        raise OSError(errno.ENOSPC, "full", str(partial / PAIR[0]))
    assert raised.value.filename == str(tmp_path / PAIR[0])
    assert pair(tmp_path) == ["old", "old"] and len(list(tmp_path.iterdir())) == 2


def test_a_file_of_others_beside_stays_and_so_do_the_rest(tmp_path):
    (tmp_path / PAIR[1]).write_text("a photo")
    with pytest.MonkeyPatch.context() as patch, pytest.raises(ProtectedFile, match=PAIR[1]):
        patch.delenv(OVERWRITE_VARIABLE, raising=False)
        write_pair(tmp_path, "new")
    assert pair(tmp_path) == [None, "a photo"]
