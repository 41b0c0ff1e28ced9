"""Tasks of a batch that fail say why, wherever they were sent."""

import pickle
from dataclasses import replace

from mbkf.io.subject import read_subject, write_subject
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.study.batch.outcome import Status
from mbkf.study.batch.plan import Files, Person, Trial
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.studies import walk_folder


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
