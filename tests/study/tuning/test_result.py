"""A result that is no better on held-out readings keeps the defaults, and says why."""

from mbkf.study.tuning.result import Tuned, TunedParameter


def test_what_holds_no_better_keeps_the_defaults():
    likelihood = {"tuned_before": 1.0, "tuned_after": 2.0, "held_out_before": 1.0, "held_out_after": 0.9}
    parts = (TunedParameter("motion", 10.0, 30.0, True),)
    found = Tuned("dynamic", parts, {"a": 10.0}, {"a": 1.0}, likelihood, ("x",), ("y",), 9, True, 1.0)
    assert not found.better
    assert len(found.warnings) == 2
    saved = found.preset("p")
    assert (saved.values, saved.found) == ({"a": 1.0}, {"a": 10.0})
    assert "keeps the defaults" in saved.note
