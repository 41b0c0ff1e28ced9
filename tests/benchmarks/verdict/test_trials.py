"""Right trials of the benchmark of verdicts are not those that bounds were set on."""

from pathlib import Path

from benchmarks.loads.trials import clean_trials
from benchmarks.verdict.trials import MADE_MODEL, Judged, shown_right

NAN = float("nan")


def test_no_shown_trial_is_one_that_bounds_were_set_on():
    chosen = {one.label for one in clean_trials(Path(), Path())}
    shown = shown_right(Path(), Path("made"))
    assert chosen.isdisjoint({one.label for one in shown if one.kind == "own"})
    assert {one.folder.parent.name for one in shown if one.kind == "foreign"} == {MADE_MODEL}


def test_only_large_errors_under_use_are_wrong():
    assert Judged("walk", "use", 0.0, 0.4, "").wrong_in_use
    assert Judged("walk", "use", 10.5, 0.0, "").wrong_in_use
    assert not Judged("walk", "use", 9.5, 0.29, "").wrong_in_use
    assert not Judged("walk", "look", 20.0, 0.4, "").wrong_in_use
    assert not Judged("walk", "use", NAN, NAN, "").wrong_in_use
