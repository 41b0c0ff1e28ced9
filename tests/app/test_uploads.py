"""Dropped files lie in the folder only, whole, under names that the disk holds, and replace no other file."""

import errno
import shutil

import pytest

from mbkf.app import uploads as module
from mbkf.app.failures import Refused, failure
from mbkf.app.uploads import MOST_BYTES, RESULTS, putting
from mbkf.errors import InvalidInput


@pytest.fixture
def root(tmp_path):
    made = tmp_path / "lab"
    made.mkdir()
    return made


def put(root, name, content=b"x", size=None):
    with putting(root, name, size) as file:
        file.write(content)


def test_files_are_put_into_the_folder_only(root, tmp_path):
    put(root, "P3/monday/walk.c3d", b"capture")
    assert (root / "P3" / "monday" / "walk.c3d").read_bytes() == b"capture"
    (root / "out").symlink_to(tmp_path)
    for name in (
        "", "/etc/passwd", "../x.c3d", "a/../../x", "a/./../x", ".hidden", "a/.b/c", "a\\b", "C:x", "x\0y", "n" * 300,
        "a/b/c/d/e/f.c3d", "out/x.c3d", "~/x\n", "\ud800.c3d", f"{RESULTS}/runs.json",
    ):  # fmt: skip
        with pytest.raises(InvalidInput):
            put(root, name)
    assert not (tmp_path / "x.c3d").exists()


def test_a_folder_that_is_a_link_to_itself_is_an_error_of_the_disk(root):
    (root / "loop").symlink_to(root / "loop")
    with pytest.raises(OSError, match="loop"):
        put(root, "loop/x.c3d")


def test_names_are_measured_in_bytes(root):
    with pytest.raises(InvalidInput, match="244 bytes is too long"):
        put(root, "P1/" + "😀" * 60 + ".c3d")
    put(root, "P1/" + "😀" * 49 + ".c3d")
    put(root, "P1/" + "n" * (MOST_BYTES - 4) + ".c3d")


def test_a_broken_off_file_is_not_there(root):
    with pytest.raises(ConnectionError), putting(root, "P3/walk.c3d") as file:
        file.write(b"half")
        raise ConnectionError
    assert list((root / "P3").iterdir()) == []


def test_the_part_of_another_file_that_a_killed_page_left_is_swept(root):
    left = root / f".video-{32 * 'a'}.mp4"
    left.write_bytes(b"part")
    put(root, "walk.c3d")
    assert [one.name for one in root.iterdir()] == ["walk.c3d"]


def test_a_file_is_never_replaced(root):
    put(root, "P1/walk.c3d", b"first")
    put(root, "P1/walk.c3d", b"first", 5)
    for content in (b"other", b"longer"):
        with pytest.raises(Refused, match="is here already with another content") as refused:
            put(root, "P1/walk.c3d", content)
        assert refused.value.status == 409
    with pytest.raises(Refused):
        put(root, "P1/walk.c3d", b"", 6)
    assert [(path.name, path.read_bytes()) for path in (root / "P1").iterdir()] == [("walk.c3d", b"first")]


def test_a_file_in_the_place_of_a_folder_and_the_reverse(root):
    put(root, "P1/walk.c3d")
    for name in ("P1/walk.c3d/inner.c3d", "P1"):
        with pytest.raises(OSError) as refused:
            put(root, name)
        status, text = failure(refused.value)
        assert status == 409 and "stands where a" in text


def test_a_file_that_does_not_fit_is_refused_before_it_is_sent(root, monkeypatch):
    monkeypatch.setattr(module.shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(100, 90, 10))
    with pytest.raises(OSError) as refused, putting(root, "P1/walk.c3d", 11):
        pytest.fail("it was opened")
    assert refused.value.errno == errno.ENOSPC
    put(root, "P1/walk.c3d", b"0123456789", 10)
