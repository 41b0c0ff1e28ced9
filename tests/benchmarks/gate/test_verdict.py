"""The gate's comparison: worse is worse in every direction, what is not a number never passes."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.gate.baseline import Baseline, Held, held
from benchmarks.gate.metrics import HIGHER, LOWER, NEAR_ONE, Metric
from benchmarks.gate.verdict import Kind, verdict, verdicts

numbers = st.floats(0.0, 1e3)
ways = st.sampled_from([LOWER, HIGHER, NEAR_ONE])


@given(numbers, numbers, st.floats(0.0, 10.0))
def test_directions_mirror_each_other(was, now, tolerance):
    lower = verdict(Metric("x", now, "", LOWER), Held(was, "", LOWER, tolerance))
    higher = verdict(Metric("x", was, "", HIGHER), Held(now, "", HIGHER, tolerance))
    assert lower.kind == higher.kind
    if lower.kind == Kind.WORSE:
        assert now > was + tolerance * (1.0 - 1e-9)


@given(numbers, ways, st.floats(0.0, 10.0))
def test_what_it_was_passes_and_what_is_not_a_number_never_does(was, better, tolerance):
    one = Held(was, "", better, tolerance)
    assert verdict(Metric("x", was, "", better), one).kind == Kind.PASS
    assert verdict(Metric("x", math.nan, "", better), one).kind == Kind.WORSE
    assert not verdict(Metric("x", math.nan, "", better), one).passed


@given(numbers, ways)
def test_a_metric_s_own_baseline_lets_it_pass(value, better):
    metric = Metric("x", value, "mm", better)
    assert verdict(metric, held(metric)).kind == Kind.PASS


@pytest.mark.parametrize(
    "now, kind",
    [(0.8, Kind.PASS), (1.2, Kind.PASS), (0.7, Kind.WORSE), (1.3, Kind.WORSE), (1.0, Kind.BETTER)],
)
def test_consistency_gets_worse_on_both_sides_of_one(now, kind):
    assert verdict(Metric("NEES", now, "", NEAR_ONE), Held(1.15, "", NEAR_ONE, 0.06)).kind == kind


def test_new_and_gone_metrics_shut_the_gate():
    baseline = Baseline({"a": Held(1.0, "", LOWER, 0.1), "gone": Held(1.0, "", LOWER, 0.1)})
    found = {one.name: one for one in verdicts([Metric("a", 1.0), Metric("new", 1.0)], baseline)}
    assert {name: one.kind for name, one in found.items()} == {
        "a": Kind.PASS,
        "new": Kind.NEW,
        "gone": Kind.GONE,
    }
    assert [one.passed for one in found.values()] == [True, False, False]
