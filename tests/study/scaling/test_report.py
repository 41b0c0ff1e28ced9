"""A subject's report names the trials of its body, each with its evidence, and the others with their reasons."""

from mbkf.study.scaling.choice import Choice, Chosen, Part
from mbkf.study.scaling.report import LEFT_OUT_KEY, as_report, bends_deeply, scaled_from, used_trials

WALK = Chosen("walk1", Part.WALK, "both legs step")
SQUAT = Chosen("squat", Part.DEEP, "hips bend to 100°")


def test_each_trial_has_its_line():
    report = as_report("static", Choice((WALK, SQUAT), {"run": "impacts"}))
    assert scaled_from(report) == [
        "scaled from static (standing)",
        "scaled from walk1 (walk: both legs step)",
        "scaled from squat (deep flexion: hips bend to 100°)",
        "not scaled from run: impacts",
    ]
    assert used_trials(report) == ["static", "walk1", "squat"] and used_trials({}) == []
    assert scaled_from({}) == [] and LEFT_OUT_KEY not in as_report("static", Choice((WALK,)))


def test_a_deep_flexion_is_known():
    assert bends_deeply(as_report("static", Choice((WALK, SQUAT))))
    assert not bends_deeply(as_report("static", Choice((WALK,)))) and not bends_deeply({})
