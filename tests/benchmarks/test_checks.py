"""A check passes exactly when its value keeps its bound, and the runner's exit code says so."""

import json
import sys
from types import ModuleType

import numpy as np
import pytest

from benchmarks import __main__ as runner
from benchmarks import needs
from benchmarks.checks import Check, Context, left_out, number, within
from mbkf.errors import InvalidInput, MissingDependency


@pytest.mark.parametrize(
    ("value", "relation", "passed"),
    [
        (1.0, "<=", True),
        (1.1, "<=", False),
        (1.0, ">=", True),
        (0.9, ">=", False),
        (float("nan"), "<=", False),
        (float("nan"), ">=", False),
        (float("inf"), "<=", False),
        (np.float64(0.5), "<=", True),
    ],
)
def test_value_is_compared_with_its_bound(value, relation, passed):
    assert Check("c", value, 1.0, relation).passed is passed


def test_unknown_relation_is_refused():
    with pytest.raises(InvalidInput, match="relation"):
        Check("c", 1.0, 1.0, "<")


def test_context_without_data_says_how_to_give_them(tmp_path):
    with pytest.raises(InvalidInput, match="--data"):
        Context(None, tmp_path).require_data()
    assert Context(tmp_path, tmp_path).require_data() == tmp_path


@pytest.fixture
def fake(monkeypatch):
    """Put one benchmark called ``fake`` in place of the real ones; its result can be set."""
    module = ModuleType("benchmarks.fake")
    module.run = lambda context: [Check("error", module.value, 1.0, "<=", "mm")]
    module.value = 0.5
    monkeypatch.setitem(sys.modules, "benchmarks.fake", module)
    monkeypatch.setattr(runner, "names", lambda: ("fake",))
    monkeypatch.delenv(runner.DATA_VARIABLE, raising=False)
    return module


@pytest.mark.parametrize(
    ("value", "code", "word", "stored"),
    [(0.5, 0, "pass", 0.5), (2.0, 1, "FAIL", 2.0), (float("nan"), 1, "FAIL", None)],
)
def test_exit_code_table_and_file_agree(fake, tmp_path, capsys, value, code, word, stored):
    fake.value = value
    assert runner.main(["--out", str(tmp_path)]) == code
    assert word in capsys.readouterr().out
    (row,) = json.loads((tmp_path / "checks.json").read_text())["checks"]
    assert (row["benchmark"], row["value"], row["passed"]) == ("fake", stored, code == 0)


def test_unknown_name_and_missing_folder_exit_with_2_and_one_line(fake, tmp_path, capsys):
    assert runner.main(["nosuch", "--out", str(tmp_path)]) == 2
    assert runner.main(["--data", str(tmp_path / "none"), "--out", str(tmp_path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert "nosuch" in lines[0]
    assert "--data" in lines[1]


def test_benchmark_that_needs_absent_data_exits_with_2(fake, tmp_path, capsys):
    fake.run = lambda context: context.require_data()
    assert runner.main(["fake", "--out", str(tmp_path)]) == 2
    assert runner.DATA_VARIABLE in capsys.readouterr().err


def test_a_benchmark_without_its_library_is_left_out_unless_it_is_named(fake, tmp_path, capsys):
    def run(context):
        raise MissingDependency("opensim", "the comparison with other tools", "peers")

    fake.run = run
    assert runner.main(["--out", str(tmp_path)]) == 0
    assert "fake is left out" in (told := capsys.readouterr().out) and "pip install opensim" in told
    assert runner.main(["fake", "--out", str(tmp_path)]) == 2
    assert "pip install opensim" in capsys.readouterr().err


def test_a_band_has_two_checks():
    low, high = within("x", 0.7, 0.8, 1.25)
    assert (low.passed, high.passed) == (False, True)


def test_a_row_that_is_left_out_neither_passes_nor_fails(fake, tmp_path, capsys):
    fake.run = lambda context: [left_out("torque", ".[extra] lacks"), Check("error", 0.5, 1.0, "<=")]
    assert runner.main(["--out", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    assert "left out: .[extra] lacks" in told and told.count("pass") == 1
    first, second = json.loads((tmp_path / "checks.json").read_text())["checks"]
    assert (first["passed"], first["value"], first["note"], second["passed"]) == (
        None,
        None,
        ".[extra] lacks",
        True,
    )


def test_a_benchmark_without_captures_is_left_out_unless_it_is_named(fake, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(needs.NEEDS, "fake", needs.Needs(captures=("some_walk",)))
    assert runner.main(["--out", str(tmp_path)]) == 0
    assert "fake is left out: fake needs captures (some_walk); docs/captures.md" in capsys.readouterr().out
    assert runner.main(["fake", "--out", str(tmp_path)]) == 2
    assert "needs captures (some_walk)" in capsys.readouterr().err


def test_a_missing_number_passes_no_bound():
    assert not Check("x", number(None), 1.0, "<=").passed
    assert Check("x", number(0.5), 1.0, "<=").passed
