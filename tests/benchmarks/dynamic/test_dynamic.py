"""The table as a whole: its parts, and that one that does not run fails its own rows only."""

from pathlib import Path

from benchmarks import dynamic
from benchmarks.__main__ import names
from benchmarks.checks import Check
from benchmarks.dynamic.methods import Method, dynamic_pair, in_turn
from mbkf.errors import InvalidInput


def test_it_is_one_benchmark_and_its_helpers_are_none():
    assert [name for name in names() if name.startswith("dynamic")] == ["dynamic"]


def test_the_quick_table_is_a_part_of_the_full_one():
    full, quick = (
        [name for name, _ in dynamic.parts(Path(), dynamic_pair(), in_turn, quick=quick)]
        for quick in (False, True)
    )
    assert set(quick) <= set(full)
    assert {
        "matched noise",
        "synthetic walk",
        "synthetic squat",
        "synthetic jump",
        "a leg lost in the walk",
    } <= set(full)


def test_a_part_that_does_not_run_is_a_failed_row(monkeypatch):
    def broken():
        raise InvalidInput("no luck")

    def parts(*_, **__):
        yield "first", broken
        yield "second", lambda: [Check("fine", 1.0, 2.0, "<=")]

    monkeypatch.setattr(dynamic, "parts", parts)
    first, second = dynamic.run_with(Path(), [Method("kinematic")], in_turn, quick=True)
    assert first.name == "first does not run: no luck"
    assert not first.passed
    assert second.passed
