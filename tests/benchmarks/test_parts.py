"""Parts of a benchmark are chosen by name, have folders of their own, and fail the benchmark when a row fails."""

import pytest

from benchmarks.checks import Check, Context
from benchmarks.parts import part_rows
from mbkf.errors import UnknownName


def test_an_unknown_part_is_refused_with_those_that_exist(tmp_path):
    with pytest.raises(UnknownName, match="files"):
        part_rows(Context(None, tmp_path, only=("file",)), {"files": lambda _: []})


def test_a_part_gets_an_empty_folder_and_names_its_rows(tmp_path):
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "old").write_text("x")

    def rows(context):
        assert list(context.out.iterdir()) == []
        yield Check("lost", 1.0, 0.0, "<=")

    parts = {"files": rows, "others": lambda _: pytest.fail("not asked for")}
    (check,) = part_rows(Context(None, tmp_path, only=("files",)), parts)
    assert check.name == "files: lost"
    assert not check.passed
