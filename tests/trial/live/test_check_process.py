"""The process that checks a run: an answer for each question, made of what the log holds by then."""

from dataclasses import replace

from mbkf.io.subject import write_subject
from mbkf.trial.live.check_process import Answer, answer_of, answers, checks_so_far
from mbkf.trial.live.log import SUBJECT_FILE
from tests.trial.live.test_running_evidence import run, subject

__all__ = ["run", "subject"]


def test_each_question_is_answered_with_the_checks_so_far(run, subject):
    *_, result, folder = run
    found = [answer_of(line) for line in answers(folder, ["check\n", "check\n"])]
    assert found == 2 * [Answer(result.checks)] and result.checks
    write_subject(replace(subject, mass_kg=1.3 * subject.mass_kg), folder / SUBJECT_FILE)
    heavy = {one.name: one for one in checks_so_far(folder).findings}["mass against plates"]
    write_subject(subject, folder / SUBJECT_FILE)
    assert heavy.verdict == "outside"


def test_a_log_that_is_not_there_yet_has_no_checks(tmp_path):
    assert list(answers(tmp_path / "log", ["check\n"])) == ['{"findings": [], "exchanged": []}']
    assert answer_of('{"findings": [], "exchanged": [["A", "B", 0.9]]}').exchanged == (("A", "B", 0.9),)


def test_the_person_is_judged_from_a_frame_on(run, subject):
    *_, folder = run
    (own,) = answer_of(next(answers(folder, ["person 20"]))).findings
    other = replace(subject, scale_factors={name: 0.8 * one for name, one in subject.scale_factors.items()})
    write_subject(other, folder / SUBJECT_FILE)
    (strange,) = answer_of(next(answers(folder, ["person 20"]))).findings
    write_subject(subject, folder / SUBJECT_FILE)
    assert own.verdict != "outside" and strange.verdict == "outside"
    assert answer_of(next(answers(folder / "gone", ["person 0"]))) == Answer()
