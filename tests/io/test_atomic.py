"""A file is replaced whole or not at all."""

import pytest

from mbkf.io.atomic import replacing


def test_new_content_takes_the_place_of_the_old_and_folders_are_made(tmp_path):
    target = tmp_path / "new" / "deep.txt"
    for text in ("first", "second"):
        with replacing(target) as temporary:
            assert temporary.suffix == ".txt"
            temporary.write_text(text)
        assert target.read_text() == text
    assert [path.name for path in target.parent.iterdir()] == ["deep.txt"]


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "file.txt"
    target.write_text("old")
    with pytest.raises(ValueError, match="halfway"), replacing(target) as temporary:
        temporary.write_text("half")
        raise ValueError("halfway")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
