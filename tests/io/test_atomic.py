"""A file is replaced whole or not at all."""

import pytest

from mbkf.errors import FileFormatError
from mbkf.io.atomic import check_folder, replacing, write_text
from mbkf.io.written import overwriting


@pytest.fixture(autouse=True)
def of_anyone():
    """Replaces whatever stands there; tests/io/test_written.py is about files of others."""
    with overwriting():
        yield


def test_new_content_takes_the_place_of_the_old_and_folders_are_made(tmp_path):
    target = tmp_path / "new" / "deep.txt"
    for text in ("first", "second"):
        with replacing(target) as temporary:
            assert temporary.suffix == ".txt"
            temporary.write_text(text)
        assert target.read_text() == text
    assert [path.name for path in target.parent.iterdir()] == ["deep.txt"]


def test_a_text_is_written_whole(tmp_path):
    for text in ("first é", "second"):
        write_text(tmp_path / "new" / "file.txt", text)
        assert (tmp_path / "new" / "file.txt").read_text(encoding="utf-8") == text


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "file.txt"
    target.write_text("old")
    with pytest.raises(ValueError, match="halfway"), replacing(target) as temporary:
        temporary.write_text("half")
        raise ValueError("halfway")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_the_unfinished_file_is_empty_and_swept_names_do_not_matter(tmp_path):
    with replacing(tmp_path / "file.txt") as temporary:
        assert temporary.read_bytes() == b""
        temporary.write_text("new")
        with replacing(tmp_path / "file.txt") as other:
            assert other != temporary and temporary.exists()
            other.write_text("newer")
    assert (tmp_path / "file.txt").read_text() == "new"


def test_a_folder_is_checked_and_not_made(tmp_path):
    target = tmp_path / "a" / "b"
    assert check_folder(target) == target
    assert list(tmp_path.iterdir()) == []


def test_a_file_on_the_way_is_refused(tmp_path):
    (tmp_path / "out").write_text("a file")
    for place in (tmp_path / "out", tmp_path / "out" / "deeper"):
        with pytest.raises(FileFormatError, match="name another folder"):
            check_folder(place)


def test_a_folder_in_the_place_of_a_file_is_refused(tmp_path):
    (tmp_path / "out" / "b.txt").mkdir(parents=True)
    assert check_folder(tmp_path / "out", ["a.txt"]) == tmp_path / "out"
    with pytest.raises(FileFormatError, match="a folder stands where a file is needed"):
        check_folder(tmp_path / "out", ["a.txt", "b.txt"])
