"""The benchmark of the source tree reads lists, outputs and graphs as they are, and compares trees pair by pair."""

import argparse
from pathlib import Path

import pytest

from benchmarks import __main__ as runner
from benchmarks import house
from benchmarks.house import examples, step_files, step_time
from benchmarks.house.circles import circles, imported_modules
from benchmarks.house.sources import parsed
from mbkf.errors import InvalidInput

PAGE = """# Page

```{step-files}
filters/filter.py: The order
  of a step.
sensors/block.py: What a block is.
```

```{step-files-left-out}
sensors/skin.py: An option.
```
"""


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "page.md"
    path.write_text(PAGE, encoding="utf-8")
    return path


def test_files_of_a_step_are_read_from_the_page_and_counted_in_the_tree(page):
    one, other = step_files.listed(step_files.READ, page)
    assert (one.path, one.sentence) == ("filters/filter.py", "The order of a step.")
    assert one.lines == step_files.lines_of(step_files.PACKAGE / "filters" / "filter.py")
    assert other.path == "sensors/block.py"


def test_executed_files_are_in_one_of_the_lists_or_in_another_room(page):
    executed = {"sensors/skin.py", "sensors/block.py", "model/human.py", "sensors/new.py"}
    assert step_files.undeclared(executed, page) == ["sensors/new.py"]


@pytest.mark.parametrize("line", ["sensors/gone.py: No longer there.", "no file at all"])
def test_a_list_that_the_tree_has_outgrown_is_an_error(line):
    with pytest.raises(InvalidInput):
        step_files.parsed([line])


def test_a_page_without_its_list_is_an_error(tmp_path):
    empty = tmp_path / "page.md"
    empty.write_text("# Page\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match="no list"):
        step_files.listed(step_files.READ, empty)


def test_the_pages_own_lists_hold_every_executed_file_and_no_other():
    executed = step_files.executed_in_a_step()
    assert step_files.undeclared(executed) == []
    kinds = (step_files.READ, step_files.LEFT_OUT)
    files = [one.path for kind in kinds for one in step_files.listed(kind)]
    assert len(files) == len(set(files))
    # A protocol may be listed whose functions nothing calls.
    assert set(files) - executed <= {"sensors/block.py"}


def test_an_error_is_read_from_the_line_that_names_it():
    output = "with 3 N of noise\nplate withheld: under the right foot 23.9 N RMS\nand insole: 9.2 N\n"
    assert examples.error_n(output, examples.WITHHELD) == 23.9
    assert examples.error_n(output, examples.INSOLE) == 9.2
    assert examples.error_n("", examples.INSOLE) != examples.error_n("", examples.INSOLE)


def test_tests_of_a_block_are_counted_by_their_parameter():
    collected = (
        "tests/a.py::test_x[Own]\ntests/a.py::test_y[Own-0]\ntests/a.py::test_y[Owner-0]\n1 tests about Own\n"
    )
    assert house.named_in(collected, "Own") == 2


def test_circles_are_found_in_a_tree_of_files(tmp_path):
    (tmp_path / "mbkf").mkdir()
    for name, text in {
        "a": "from mbkf import b",
        "b": "def f():\n    import mbkf.a",
        "c": "import mbkf.b",
    }.items():
        (tmp_path / "mbkf" / f"{name}.py").write_text(text, encoding="utf-8")
    assert circles(tmp_path, ["mbkf"]) == ["mbkf/a.py", "mbkf/b.py", "mbkf/a.py"]
    (tmp_path / "mbkf" / "b.py").write_text("", encoding="utf-8")
    assert circles(tmp_path, ["mbkf"]) == []


def test_imports_are_found_however_deep_they_stand():
    source = """
class A:
    def f(self):
        try:
            import a
        except E:
            import b
        else:
            match x:
                case 1:
                    from c import d
"""
    assert imported_modules(parsed(source), "mbkf") == {"a", "b", "c.d"}
    assert parsed(source) is parsed(source)


def test_trees_are_timed_in_turn_after_a_block_that_does_not_count():
    calls = []

    def tree(name, seconds):
        def timed(what):
            calls.append((name, what))
            return seconds

        return timed

    times = step_time.alternating(tree("old", 2.0), tree("new", 3.0), ["x"], pairs=2)
    assert times == {"x": ([2.0, 2.0], [3.0, 3.0])}
    assert [name for name, _ in calls] == ["old", "new", "new", "old", "old", "new"]
    assert step_time.median_ratio([1.0, 1.0, 10.0], [1.1, 1.2, 1.0]) == pytest.approx(1.1)


def test_a_tree_without_the_package_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="--old"), step_time._worker(tmp_path, tmp_path):
        pass


@pytest.mark.slow
def test_a_tree_is_as_quick_as_itself(tmp_path):
    checks = step_time.rows(step_files.ROOT, tmp_path / "squat", pairs=3)
    ratios = [check.value for check in checks if check.bounded]
    assert len(ratios) == 2 and all(0.5 < ratio < 2.0 for ratio in ratios)


def test_another_tree_is_named_on_the_command_line(tmp_path, monkeypatch):
    monkeypatch.setenv(runner.OLD_VARIABLE, str(tmp_path))
    found = runner._parser().parse_args([])
    assert runner.context_of(found, tmp_path).old == Path(tmp_path)
    named = argparse.Namespace(data=None, quick=True, old=None, minutes=None, seed=0, only=())
    assert runner.context_of(named, tmp_path).old is None


def test_a_tree_that_does_not_exist_is_refused(tmp_path, capsys):
    assert runner.main(["house", "--old", str(tmp_path / "none"), "--out", str(tmp_path)]) == 2
    assert "--old TREE" in capsys.readouterr().err
