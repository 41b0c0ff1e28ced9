"""A session's body: from standing and the trials that help, from standing alone where they do not fit one body."""

from dataclasses import replace
from functools import partial

import pytest

from mbkf.errors import FileFormatError, NotConverged, NotObservable
from mbkf.io.capture import read_capture
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.study.scaling.choice import Part
from mbkf.study.scaling.report import LEFT_OUT_KEY, SCALED_FROM_KEY
from mbkf.study.scaling.session import (
    MOST_FRAMES,
    MOVING_FRAMES,
    STANDING_FRAMES,
    SessionTrial,
    chosen_trials,
    new_doubts,
    scale_from_moving,
    scale_from_session,
)
from mbkf.trial.scale import scale
from tests.bending import MASS_KG, arms_lifted, squat, stander, standing, walk

STATIC = SessionTrial("static", standing)
THESIS = ScalingSettings(thesis_factors=True)


class Scaling:
    """Notes the captures and frames of each scaling, which answers with the standing person, or what it is told to."""

    def __init__(self, *answers):
        self.calls, self.settings, self.answers = [], [], list(answers)

    def __call__(self, static, trials, settings=None, progress=None):
        self.calls.append((len(trials), settings.frames_per_trial))
        self.settings.append(replace(settings, frames_per_trial=40))
        answer = self.answers.pop(0) if len(trials) and self.answers else stander()
        if isinstance(answer, Exception):
            raise answer
        return answer


def damaged():
    raise FileFormatError("film.c3d", "is no capture")


TRIALS = (
    SessionTrial("walk1", walk),
    SessionTrial("other", partial(squat, factor=1.1)),
    SessionTrial("squat", squat),
    SessionTrial("arms", arms_lifted),
    SessionTrial("film", damaged),
)


def test_the_trials_that_help_are_scaled_together_with_standing():
    scaling, stages = Scaling(), []
    found = scale_from_session(STATIC, TRIALS, scaling, THESIS, lambda *stage: stages.append(stage))
    report = found.subject.report
    assert [(one["trial"], one["part"]) for one in report[SCALED_FROM_KEY]] == [
        ("static", "standing"), ("walk1", "walk"), ("squat", "deep flexion"), ("arms", "trunk and arms"),
    ]  # fmt: skip
    assert (
        "is no capture" in report[LEFT_OUT_KEY]["film"] and "another person" in report[LEFT_OUT_KEY]["other"]
    )
    assert scaling.calls == [(0, STANDING_FRAMES), (3, MOST_FRAMES // 4)] and len(found.captures) == 4
    assert set(scaling.settings) == {THESIS}
    assert stages[0] == ("Choosing trials", 0, 5) and stages[-1] == ("Choosing trials", 5, 5)


def test_the_choice_does_not_depend_on_the_order_of_the_trials():
    one, other = (scale_from_session(STATIC, trials, Scaling()).subject for trials in (TRIALS, TRIALS[::-1]))
    assert one.report == other.report


def test_a_second_round_of_names_is_looked_at_only_where_the_first_is_not_enough():
    again = SessionTrial("walk2", damaged)
    assert "walk2" not in scale_from_session(STATIC, (*TRIALS, again), Scaling()).subject.report[LEFT_OUT_KEY]
    report = scale_from_session(STATIC, (TRIALS[0], again), Scaling()).subject.report
    assert "is no capture" in report[LEFT_OUT_KEY]["walk2"]


def test_standing_alone_is_scaled_as_ever():
    scaling = Scaling()
    found = scale_from_session(STATIC, (), scaling)
    assert scaling.calls == [(0, 40)] and found.captures == (standing(),)
    assert found.subject.report[SCALED_FROM_KEY] == [{"trial": "static", "part": "standing", "why": ""}]
    assert LEFT_OUT_KEY not in found.subject.report


def test_trials_that_do_not_fit_one_likely_body_with_standing_are_left_out():
    doubtful = replace(stander(), report={**stander().report, DOUBTS_KEY: ["proportions are unusual"]})
    assert new_doubts(doubtful, stander()) == "proportions are unusual"
    assert new_doubts(doubtful, doubtful) == new_doubts(stander(), stander()) == ""
    for answer, why in ((doubtful, "proportions are unusual"), (NotConverged("no fit"), "no fit")):
        scaling = Scaling(answer)
        found = scale_from_session(STATIC, TRIALS[:1], scaling)
        assert scaling.calls[1:] == [(1, MOST_FRAMES // 2), (0, 40)] and len(found.captures) == 1
        assert why in found.subject.report[LEFT_OUT_KEY]["walk1"]
        assert [one["trial"] for one in found.subject.report[SCALED_FROM_KEY]] == ["static"]


def test_a_standing_trial_that_cannot_be_scaled_is_an_error():
    def refuse(static, trials, settings=None, progress=None):
        raise NotObservable("two markers")

    with pytest.raises(NotObservable, match="two markers"):
        scale_from_session(STATIC, TRIALS, refuse)


def test_real_scaling_takes_them():
    found = scale_from_session(STATIC, TRIALS[:3], partial(scale, mass_kg=MASS_KG)).subject
    assert found.report["frames"] == 3 * (MOST_FRAMES // 3) and found.report["marker_rms_mm"] < 2.0


def test_without_a_standing_trial_the_first_one_that_gives_a_body_judges_the_others():
    scaling = Scaling()
    found = scale_from_moving(TRIALS[:4], scaling, THESIS)
    report = found.subject.report
    assert [one["part"] for one in report[SCALED_FROM_KEY]] == ["walk", "deep flexion", "trunk and arms"]
    assert list(report[LEFT_OUT_KEY]) == ["other"] and set(scaling.settings) == {THESIS}
    assert scaling.calls == [(1, MOVING_FRAMES), (3, MOST_FRAMES // 3)] and len(found.captures) == 3
    assert report == scale_from_moving(TRIALS[3::-1], Scaling(), THESIS).subject.report


def test_where_no_movement_helps_or_no_body_fits_the_first_moving_trials_are_taken():
    still = [SessionTrial(f"trial{k}", standing) for k in range(5)]
    found = scale_from_moving(still, Scaling())
    assert [(one["trial"], one["part"]) for one in found.subject.report[SCALED_FROM_KEY]] == [
        ("trial0", "movement"), ("trial1", "movement"), ("trial2", "movement"),
    ]  # fmt: skip
    scaling = Scaling(stander(), NotConverged("no fit"))
    found = scale_from_moving(TRIALS[:1], scaling)
    assert scaling.calls == [(1, MOVING_FRAMES), (1, 40), (1, 40)]
    assert [one["part"] for one in found.subject.report[SCALED_FROM_KEY]] == ["movement"]
    with pytest.raises(NotConverged, match="no fit"):
        scale_from_moving(TRIALS[:1], Scaling(NotConverged("no"), NotConverged("no fit")))


@pytest.mark.parametrize("person", ["adult", "child"])
def test_of_persons_of_exact_truth_walk_and_squat_are_chosen(person, real_data):
    """The run has impacts; a walk of somebody else with the adult's markers is refused."""
    folder = real_data / "foreign_truth" / person
    files = {name: folder / name / "trial.trc" for name in ("walk", "squat", "run")}
    files["other"] = real_data / "rajagopal_walk_run" / "motion_capture_walk.trc"
    trials = [SessionTrial(name, partial(read_capture, file)) for name, file in files.items()]
    static = read_capture(folder / "static.trc")
    found = chosen_trials(static, trials, partial(scale, mass_kg=MASS_KG), ScalingSettings()).choice
    assert [(one.name, one.part) for one in found.chosen] == [("walk", Part.WALK), ("squat", Part.DEEP)]
    assert list(found.left_out) == ["other", "run"] and found.complete
