"""A trial against the capture that its person was scaled from: refused, remarked on, or silently right."""

from dataclasses import replace
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError
from mbkf.study.batch import other_person
from mbkf.study.batch.other_person import checked_owner, plan_of_others, reference_of
from mbkf.study.batch.outcome import AnotherPerson
from mbkf.study.batch.plan import Files, Person, Trial
from mbkf.study.scaling.report import SCALED_FROM_KEY
from tests.bending import squat, stander, standing, walk

STATIC, WALK = Path("static.c3d"), Path("walk.c3d")
TRIAL = Trial(Person("P", statics=(STATIC,)), WALK)


@pytest.fixture(autouse=True)
def reads_standing(monkeypatch):
    monkeypatch.setattr(other_person, "read_capture", lambda path: standing())


def test_markers_where_they_were_raise_no_doubt():
    assert checked_owner(TRIAL, squat(), stander()) == ""


def test_a_trial_of_another_person_is_refused_unless_a_list_names_the_person():
    other = walk(factor=1.1)
    with pytest.raises(
        AnotherPerson, match=r"walk\.c3d: distances .* in static\.c3d .* longer.*; put it into a folder"
    ):
        checked_owner(TRIAL, other, stander())
    listed = replace(TRIAL, person=replace(TRIAL.person, listed=True))
    assert "another person, or markers put on anew" in checked_owner(listed, other, stander())


def test_markers_that_were_put_on_anew_are_a_doubt():
    doubt = checked_owner(TRIAL, walk(moved_m=0.01), stander())
    assert doubt.startswith("walk.c3d: markers were put on anew since the body was scaled: distances")


def test_without_a_capture_to_compare_with_there_is_no_doubt(monkeypatch):
    assert checked_owner(Trial(Person("P"), WALK), walk(factor=1.1), stander()) == ""

    def damaged(path):
        raise FileFormatError(path, "is cut short")

    monkeypatch.setattr(other_person, "read_capture", damaged)
    assert checked_owner(TRIAL, walk(factor=1.1), stander()) == ""


def test_the_reference_is_the_standing_trial_or_the_first_that_the_body_was_scaled_from():
    assert reference_of(TRIAL.person, stander()) == STATIC
    used = [{"trial": name, "part": "movement", "why": ""} for name in ("gone", "walk", "squat")]
    subject = replace(stander(), report={SCALED_FROM_KEY: used})
    person = Person("P", moving=(Files(Path("squat.c3d")), Files(WALK)))
    assert reference_of(person, subject) == WALK
    assert checked_owner(Trial(person, WALK), walk(factor=1.1), subject) == ""
    assert reference_of(Person("P"), subject) is None


def test_trials_of_others_are_planned_with_their_own_captures_alone():
    """Neither the body, the mass nor the standing trial of the session's person is theirs."""
    subject, forces = Path("subject.toml"), Path("b.mot")
    first = Person("P", "day", (STATIC,), mass_kg=70.0, height_m=1.8, subject=subject, protocol="reference36")
    second = replace(first, name="Q")
    trials = [Trial(first, Path("a.c3d")), Trial(second, WALK), Trial(first, Path("b.c3d"), forces)]
    plan = plan_of_others(trials)
    places = ["P-other/day/a", "P-other/day/b", "Q-other/day/walk"]
    assert [trial.place.as_posix() for trial in plan.trials] == places
    other = plan.trials[0].person
    assert other.unsorted == (Files(Path("a.c3d")), Files(Path("b.c3d"), forces))
    assert (other.statics, other.mass_kg, other.height_m, other.subject) == ((), None, None, None)
    assert (
        other.protocol == "reference36"
        and "capture that P was scaled from: another person" in other.remarks[0]
    )
