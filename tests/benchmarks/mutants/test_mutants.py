"""Mutants are tried in a copy of the tree: those that no test sees survive, and the copy is right again afterwards."""

import math

import pytest

from benchmarks.mutants import EVERY, anchor_rows, kill_rows
from benchmarks.mutants.copy import Copy
from benchmarks.mutants.mutant import ROOT, Mutant, mirrored_tests, read_mutants, times_found
from mbkf.errors import InvalidInput, MbkfError

CODE = "def double(x):\n    return 2 * x\n\ndef half(x):\n    return x / 2\n"
TEST = "from mbkf.room.sums import double\n\ndef test_double():\n    assert double(3) == 6\n"
DOUBLE = Mutant("mbkf/room/sums.py", "2 * x", "3 * x", ("tests/room/test_sums.py",))
HALF = Mutant("mbkf/room/sums.py", "x / 2", "x / 3", ("tests/room/test_sums.py",))


@pytest.fixture
def tree(tmp_path):
    """A tree of one room, with one function that is tested and one that is not."""
    files = {
        "mbkf/__init__.py": "",
        "mbkf/room/__init__.py": "",
        "mbkf/room/sums.py": CODE,
        "mbkf/other/alone.py": "x = 1\n",
        "tests/room/test_sums.py": TEST,
        "tests/room/test_more.py": "import mbkf.room.sums\n",
        "tests/room/test_other.py": "import math\n",
        "pyproject.toml": "[tool.pytest.ini_options]\nmarkers = ['slow']\n",
    }
    for name, text in files.items():
        path = tmp_path / "tree" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path / "tree"


def test_a_mutant_is_killed_where_a_test_sees_it_and_nothing_stays_changed(tree, tmp_path):
    copy = Copy.of(tree, tmp_path / "copy")
    assert [copy.kills(one) for one in (DOUBLE, HALF, DOUBLE)] == [True, False, True]
    assert copy.failure(DOUBLE.tests) == ""
    for root in (tree, copy.root):
        assert (root / DOUBLE.file).read_text(encoding="utf-8") == CODE


def test_a_file_that_no_longer_imports_is_a_failure_and_no_test_at_all_an_error(tree, tmp_path):
    copy = Copy.of(tree, tmp_path / "copy")
    assert copy.kills(Mutant(DOUBLE.file, "def double", "def twice", DOUBLE.tests))
    with pytest.raises(MbkfError, match="no quick test"):
        copy.failure(["tests/room/test_other.py"])


def test_mirrored_tests_a_module_have_its_name_or_import_it(tree):
    named = ["tests/room/test_more.py", "tests/room/test_sums.py"]
    assert mirrored_tests(tree / "mbkf/room/sums.py", tree) == named
    assert mirrored_tests(tree / "mbkf/room/sums.c", tree) == ["tests/room"]


@pytest.mark.parametrize(
    ("file", "new", "match"),
    [("mbkf/room/sums.py", "2 * x", "changes nothing"), ("mbkf/other/alone.py", "3 * x", "no test")],
)
def test_a_list_with_a_useless_mutant_is_refused(file, new, match, tree):
    path = tree / "list.toml"
    path.write_text(f"[[mutant]]\nfile = '{file}'\nold = '2 * x'\nnew = '{new}'\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match=match):
        read_mutants(path, tree)


def test_a_text_that_the_tree_has_outgrown_fails_with_a_row_of_its_own(tree):
    lost = Mutant(DOUBLE.file, "4 * x", "5 * x", DOUBLE.tests)
    twice = Mutant(DOUBLE.file, "return", "yield", DOUBLE.tests)
    gone = Mutant("mbkf/room/gone.py", "1", "2", DOUBLE.tests)
    each = [DOUBLE, lost, twice, gone]
    times = [times_found(one, tree) for one in each]
    assert times == [1, 0, 2, 0]
    *rows, count = anchor_rows(each, times)
    assert [row.value for row in rows] == [0, 2, 0]
    assert count.value == 3 and not count.passed
    assert anchor_rows([DOUBLE], [1])[-1].passed


def test_survivors_have_rows_and_the_share_of_the_killed_its_bound():
    *rows, count, share = kill_rows([DOUBLE, HALF], [True, False])
    assert [str(HALF) in row.name for row in rows] == [True]
    assert (count.value, share.value, share.passed) == (2, 0.5, False)
    assert kill_rows(20 * [DOUBLE], [False, *(19 * [True])])[-1].passed
    assert math.isnan(kill_rows([], [])[-1].value) and not kill_rows([], [])[-1].passed


def test_the_list_reaches_all_rooms_and_its_quick_part_several():
    mutants = read_mutants()
    rooms = {path.name for path in (ROOT / "mbkf").iterdir() if (path / "__init__.py").is_file()}
    assert len(mutants) >= 60
    assert {one.file.split("/")[1] for one in mutants} == rooms
    assert len({one.file.split("/")[1] for one in mutants[::EVERY]}) > len(rooms) / 2
