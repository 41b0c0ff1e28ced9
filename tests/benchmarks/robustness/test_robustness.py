"""Damage is the same from the same seed; what becomes of it is told, also when the process dies or hangs of it."""

import numpy as np
import pytest

from benchmarks import robustness
from benchmarks.robustness import child
from benchmarks.robustness.formats import Format, formats
from benchmarks.robustness.mutations import mutated
from mbkf.errors import InvalidInput


@pytest.mark.parametrize("text", [False, True])
def test_a_seed_damages_always_alike(text):
    content = b"name = 1.5\nother = [2, 3]\n" * 20
    found = [mutated(content, seed, text) for seed in range(50)]
    assert found == [mutated(content, seed, text) for seed in range(50)]
    assert sum(one != content for one in found) > 40
    assert mutated(b"", 3, text) is not None


def raising(error):
    def read(_path):
        raise error

    return read


def test_outcomes_are_told_apart(tmp_path):
    file = tmp_path / "x.toml"
    file.write_text("a = 1\n")

    def told(read):
        return child.outcome("x", Format(file, read, True), 0, tmp_path / "damaged")

    assert told(lambda _: True) == child.READ and told(lambda _: False) == child.IMPOSSIBLE
    assert told(raising(InvalidInput("no"))) == child.REFUSED
    assert told(raising(ZeroDivisionError("x"))).startswith("foreign ZeroDivisionError")
    assert told(lambda _: bool(np.float64(1.0) / np.float64(0.0))).startswith("foreign RuntimeWarning")
    assert list((tmp_path / "damaged").iterdir()) == []


def test_a_process_that_dies_or_hangs_costs_only_its_file(monkeypatch, tmp_path):
    asked = []

    def process(words, _folder, _data, found):
        asked.append(list(words))
        for word in words:
            if word in {"a:2", "a:4"}:
                return word, word == "a:4"
            found[word] = child.READ
        return words[-1], False

    monkeypatch.setattr(robustness, "_one_process", process)
    found = robustness.read_all([f"a:{k}" for k in range(6)], tmp_path, None)
    assert found == {"a:0": "read", "a:1": "read", "a:2": "died", "a:3": "read", "a:4": "hung", "a:5": "read"}
    assert [len(words) for words in asked] == [6, 3, 1]
    rows = {row.name: row for row in robustness.rows(found)}
    assert rows["of which the process died"].value == 1.0 and not rows["of which the process died"].passed


def test_the_slowest_refusal_is_named():
    found = {"a:1": "refused 0.100", "a:2": "refused 2.500", "b:3": "read 9.000"}
    (row,) = [row for row in robustness.rows(found) if row.name.startswith("slowest refusal")]
    assert (row.name, row.value, row.unit, row.passed) == ("slowest refusal (a:2)", 2.5, "s", False)
    assert robustness.rows({})[3].value == 0.0


@pytest.mark.slow
def test_damaged_files_of_every_format_are_read_or_refused(tmp_path):
    names = sorted(formats(tmp_path))
    found = robustness.read_all([f"{name}:{seed}" for name in names for seed in range(8)], tmp_path, None)
    assert len(found) == 8 * len(names)
    assert {outcome.split()[0] for outcome in found.values()} <= {child.READ, child.REFUSED}, found
