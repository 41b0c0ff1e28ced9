"""Tasks of a batch that fail say why, wherever they were sent."""

import pickle

from mbkf.study.batch.outcome import Status
from mbkf.study.batch.plan import Files, Person, Trial
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson
from mbkf.trial.preparation.settings import ReconstructSettings


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
