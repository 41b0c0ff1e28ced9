"""The batch benchmark's own arithmetic: which cells differ, and which trial befalls what."""

from pathlib import Path

import pyarrow as pa

from benchmarks.batch import OF_THE_RUN, differing
from benchmarks.batch.faults import FULL, KILLED, Full, Killed, _befallen
from benchmarks.batch.study import fresh
from mbkf.study.batch.plan import Person, Trial
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson
from mbkf.trial.preparation.settings import ReconstructSettings


def test_cells_that_differ_are_counted_those_of_the_run_are_not():
    one = pa.table({"trial": ["a", "b"], "x": [1.0, 2.0], OF_THE_RUN[0]: [1.0, 1.0]})
    other = pa.table({"trial": ["a", "b"], "x": [1.0, 3.0], OF_THE_RUN[0]: [5.0, 9.0]})
    assert differing(one, one) == 0
    assert differing(one, other) > 0
    assert differing(one, one, other) == differing(one, other)


def test_a_fresh_folder_is_not_there(tmp_path):
    first = fresh(tmp_path / "out")
    first.mkdir()
    assert not fresh(tmp_path / "out").exists() and fresh(tmp_path / "out") != first


def test_two_trials_of_the_first_person_go_wrong_and_no_other():
    def task(person, name):
        trial = Trial(Person(person), Path(f"{name}.c3d"), name=name)
        return ReconstructTrial(trial, Path("subject.toml"), Path("out"), ReconstructSettings())

    assert isinstance(_befallen(task("P1", KILLED)), Killed)
    assert isinstance(_befallen(task("P1", FULL)), Full)
    for other in (task("P2", KILLED), task("P1", "walk09"), ScalePerson(Person("P1"), Path("out"))):
        assert _befallen(other) is other
