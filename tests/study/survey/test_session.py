"""A session is what its captures, its file and its plates say together."""

import shutil
from dataclasses import replace

import pytest

from mbkf.io.session import SESSION_FILE, SessionNotes, TrialKind, TrialNotes, write_session
from mbkf.study.survey.problems import Problem
from mbkf.study.survey.session import survey_session
from mbkf.study.survey.trial import survey_trial
from tests.studies import study, walk_folder


@pytest.fixture
def folder(tmp_path):
    place = study(tmp_path, trials=2) / "P1"
    shutil.copy(walk_folder() / "trial.c3d", place / "bad.c3d")
    (place / "bad.c3d").write_bytes((place / "bad.c3d").read_bytes()[:2000])
    return place


def test_its_trials_are_told_apart(folder):
    session = survey_session(folder)
    assert [trial.name for trial in session.trials] == ["bad", "static", "walk1", "walk2"]
    kinds = [session.kind(trial) for trial in session.trials]
    assert kinds == [TrialKind.UNKNOWN, TrialKind.STATIC, TrialKind.WALK, TrialKind.WALK]
    assert [trial.usable for trial in session.trials] == [False, True, True, True]
    assert session.problems == ()


def test_what_is_stated_counts(folder):
    notes = SessionNotes(
        mass_kg=50.0,
        trials={"static": TrialNotes(excluded="moved"), "walk1": TrialNotes(kind=TrialKind.RUN)},
    )
    write_session(notes, folder / SESSION_FILE)
    session = survey_session(
        folder, lambda path, forces: replace(survey_trial(path, forces), standing_kg=70.0)
    )
    assert session.kind(session.trials[2]) == TrialKind.RUN
    told = [problem.what for problem in session.problems]
    assert told == ["the stated mass is 50.0 kg, by the plates it is 70.0 kg", "no standing trial"]


def test_what_is_stated_above_a_session_counts(folder):
    doubtful = Problem("unknown_set")

    def survey(path, forces):
        return replace(survey_trial(path, forces), problems=(doubtful,), standing_kg=70.0)

    assert doubtful in survey_session(folder, survey, folder.parent).trials[1].problems
    write_session(SessionNotes(protocol="plug_in_gait", mass_kg=50.0), folder.parent / SESSION_FILE)
    session = survey_session(folder, survey, folder.parent)
    assert doubtful not in session.trials[1].problems
    assert [problem.key for problem in session.problems] == ["mass"]
    assert doubtful in survey_session(folder, survey).trials[1].problems, (
        "a session by itself knows of nothing above"
    )


def test_a_session_without_a_trial_is_told(tmp_path):
    session = survey_session(tmp_path)
    assert session.trials == () and session.problems[0].grave


def test_a_damaged_session_file_is_a_problem_of_its_session(folder):
    (folder / SESSION_FILE).write_text("mass_kg = 71,9\n", encoding="utf-8")
    session = survey_session(folder)
    assert session.notes == SessionNotes() and "write mass_kg = 71.9" in session.damage
    problem = session.problems[0]
    assert (problem.key, problem.values, problem.grave) == ("session_file", (session.damage,), True)
    assert len(session.trials) == 4


def test_a_statement_about_no_capture_is_a_problem_unless_it_is_a_live_run(folder):
    write_session(SessionNotes(trials={"gone": TrialNotes(excluded="fell")}), folder / SESSION_FILE)
    (problem,) = survey_session(folder).problems
    assert problem.key == "strange_trial" and "no capture of its trial 'gone'" in problem.what
    assert survey_session(folder, live_runs=("gone",)).problems == ()
