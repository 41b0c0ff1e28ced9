"""The baseline's file: read back as written, changed only with a reason, refused where it is damaged."""

from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.gate.baseline import (
    SHARE,
    TIME_SHARE,
    Baseline,
    held,
    read_baseline,
    updated,
    write_baseline,
)
from benchmarks.gate.metrics import HIGHER, LOWER, NEAR_ONE, Metric
from mbkf.errors import FileFormatError, InvalidInput

metrics = st.builds(
    Metric,
    st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), min_size=1),
    st.floats(-1e6, 1e6),
    st.sampled_from(["mm", "°", "%", "", "P"]),
    st.sampled_from([LOWER, HIGHER, NEAR_ONE]),
    st.booleans(),
)


@given(st.lists(metrics, unique_by=lambda metric: metric.name), st.text(min_size=1).filter(str.strip))
def test_a_baseline_is_read_back(tmp_path_factory, found, reason):
    file = tmp_path_factory.mktemp("baseline") / "baseline.toml"
    made = updated(updated(Baseline({}), [], "first"), found, reason, datetime(2026, 11, 23, tzinfo=UTC))
    write_baseline(made, file)
    assert read_baseline(file) == made
    assert [one.date for one in made.updates][1:] == ["2026-11-23"]


def test_tolerances_are_shares_of_what_may_go_wrong():
    assert held(Metric("x", 10.0, "mm")).tolerance == pytest.approx(SHARE * 10.0)
    assert held(Metric("x", 1.5, "", NEAR_ONE)).tolerance == pytest.approx(0.02)
    assert held(Metric("x", 3.0, "", NEAR_ONE)).tolerance == pytest.approx(SHARE * 2.0)
    assert held(Metric("x", 99.0, "%", HIGHER)).tolerance == pytest.approx(0.5)
    assert held(Metric("x", 40.0, "%", HIGHER)).tolerance == pytest.approx(SHARE * 60.0)
    assert held(Metric("x", 1.3, "P", is_time=True)).tolerance == pytest.approx(TIME_SHARE * 1.3)


@pytest.mark.parametrize("reason", ["", "  \n"])
def test_a_change_needs_a_reason(reason):
    with pytest.raises(InvalidInput, match="needs a reason"):
        updated(Baseline({}), [Metric("x", 1.0)], reason)


def test_nothing_is_held_to_what_is_not_a_number():
    with pytest.raises(InvalidInput, match="not a number: x"):
        updated(Baseline({}), [Metric("x", float("nan"))], "why")


@pytest.mark.parametrize(
    "text",
    [
        "[[metric]]\nname = 3",
        "[[metric]",
        "[[metric]]\nname='x'\nvalue=1\nunit=''\nbetter='up'\ntolerance=1\n",
    ],
)
def test_a_damaged_file_is_refused(tmp_path, text):
    (tmp_path / "baseline.toml").write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError):
        read_baseline(tmp_path / "baseline.toml")


def test_without_a_file_nothing_is_held(tmp_path):
    assert read_baseline(tmp_path / "none.toml") == Baseline({})


def test_the_committed_baseline_is_whole():
    baseline = read_baseline()
    assert len(baseline.metrics) > 100 and baseline.updates
    assert all(one.tolerance >= 0.0 for one in baseline.metrics.values())
