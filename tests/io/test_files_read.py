"""Only regular files of bounded size are read, and each is remembered."""

import os
import socket
import tracemalloc
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError
from mbkf.io.files_read import (
    check_input,
    check_regular,
    files_read,
    opened,
    own_files_read,
    place_of,
    read_bytes,
    read_state,
    read_text,
)


@pytest.fixture(params=["pipe", "socket", "device", "folder"])
def thing(request, tmp_path):
    path = tmp_path / "thing"
    if request.param == "pipe":
        os.mkfifo(path)
    elif request.param == "socket":
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(str(path))
            yield path, request.param
            return
    elif request.param == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    yield path, request.param


def test_a_link_to_itself_is_no_file_and_its_own_place(tmp_path):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    assert place_of(loop) == tmp_path.resolve() / "loop"
    with own_files_read() as files:
        files.add(loop)
        files.wrote(loop)
        assert files.name_of(loop) is None and not files.is_own(loop)
    with pytest.raises(OSError, match="symbolic links"):
        read_bytes(loop)


@pytest.mark.parametrize("read", [read_bytes, read_text, read_state, check_regular])
def test_only_regular_files_are_read(read, thing):
    path, kind = thing
    with pytest.raises(FileFormatError, match=f"cannot be read, it is a {kind}; name a file"):
        read(path)


def test_a_large_file_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(1 << 40)  # takes no room on the disk
    with pytest.raises(FileFormatError, match="larger than 2 MB"):
        read_bytes(path, 2 << 20)
    with pytest.raises(FileFormatError, match="larger than"):
        read_bytes(path)


def test_a_file_without_a_size_is_read_to_its_bound_only(tmp_path):
    assert Path("/proc/self/status").stat().st_size == 0
    assert b"Name" in read_bytes("/proc/self/status")
    with pytest.raises(FileFormatError, match="larger"):
        read_bytes("/proc/self/status", 10)


def test_a_missing_file_is_named_with_a_remedy(tmp_path):
    with pytest.raises(FileFormatError, match="no such file; name a C3D file"):
        check_input(tmp_path / "none.c3d", "name a C3D file")
    with pytest.raises(FileNotFoundError):
        read_bytes(tmp_path / "none.c3d")


def test_texts_are_read_with_or_without_a_byte_order_mark(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
    assert read_text(path) == "a\nb\nc\n"
    path.write_bytes(b"\xff")
    with pytest.raises(UnicodeDecodeError):
        read_text(path)
    assert read_text(path, errors="replace") == "�"


def test_files_are_remembered_by_task(tmp_path):
    path, state = tmp_path / "a.txt", tmp_path / "state.json"
    for one in (path, state):
        one.write_text("text")
    with own_files_read() as files:
        with opened(path) as file:
            assert file.read() == b"text"
        read_state(state)
        assert files is files_read()
        assert files.name_of(path) == str(path)
        assert files.name_of(state) is None
        assert files.name_of(tmp_path / "none") is None
        with own_files_read() as others:
            assert others.name_of(path) is None
    assert files_read().name_of(path) is None


def test_a_command_sees_the_files_of_its_threads(tmp_path):
    from threading import Thread

    path = tmp_path / "a.txt"
    path.write_text("text")
    with own_files_read(everywhere=True) as files:
        thread = Thread(target=read_bytes, args=(path,))
        thread.start()
        thread.join()
        assert files.name_of(path) == str(path)


def test_a_file_costs_its_own_size(tmp_path):
    """Not that of the largest file that would be read."""
    file = tmp_path / "subject.toml"
    file.write_bytes(b"x" * 1000)
    tracemalloc.start()
    content = read_bytes(file)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(content) == 1000 and peak < 1 << 22
