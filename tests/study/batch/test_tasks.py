"""Tasks of a batch that fail say why, wherever they were sent."""

import pickle
from dataclasses import replace

from mbkf.io.subject import read_subject, write_subject
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.study.batch.outcome import Status
from mbkf.study.batch.plan import Files, Person, Plan, Trial
from mbkf.study.batch.run import sorted_plan
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson, SortCaptures
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.studies import ThisProcess, walk_folder


def test_tasks_that_cannot_be_done_say_why(tmp_path):
    missing = tmp_path / "missing.c3d"
    person = Person("P", moving=(Files(missing),))
    for task in (
        ScalePerson(person, tmp_path),
        ReconstructTrial(Trial(person, missing), missing, tmp_path, ReconstructSettings()),
    ):
        found = pickle.loads(pickle.dumps(task))()
        assert found.status == Status.FAILED and "missing.c3d" in found.reason
        assert found.seconds >= 0.0 and found.subject is None
    assert list(tmp_path.iterdir()) == []


def test_doubts_of_scaling_and_of_the_folder_come_with_the_person(tmp_path):
    subject = read_subject(walk_folder() / "subject.toml")
    file = tmp_path / "subject.toml"
    write_subject(replace(subject, report={**subject.report, DOUBTS_KEY: ["long legs"]}), file)
    person = Person("P", subject=file, remarks=("no standing trial",))
    assert ScalePerson(person, tmp_path)().doubts == "no standing trial; long legs"


def test_captures_are_sorted_where_the_folder_leaves_their_person_open(tmp_path, monkeypatch):
    missing = Files(tmp_path / "missing.c3d")
    person = Person("P", unsorted=(missing,))
    task = pickle.loads(pickle.dumps(SortCaptures(person)))
    assert task.name == "P" and dict(task().captures.persons) == {missing.path: Person("P")}
    plan = Plan((Trial(person, missing.path), Trial(Person("Q"), missing.path)))
    assert [one.person for one in sorted_plan(plan, ThisProcess()).trials] == [Person("P"), Person("Q")]
    monkeypatch.setattr("mbkf.study.batch.tasks.sorted_captures", lambda *_, **__: 1 / 0)
    lost, kept = sorted_plan(plan, ThisProcess()).trials
    assert "could not be compared: unforeseen ZeroDivisionError" in lost.fault and not kept.fault
