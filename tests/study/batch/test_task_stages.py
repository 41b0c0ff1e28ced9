"""Stages of tasks are reported under the tasks' names, and closed when they are left."""

from pathlib import Path

from mbkf.study.batch.plan import Person, Trial
from mbkf.study.batch.progress import Progress
from mbkf.study.batch.task_stages import TaskStages
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson
from mbkf.trial.preparation.settings import ReconstructSettings


def test_a_stage_is_reported_until_it_is_left():
    told, person = [], Person("P1", "monday")
    stages = TaskStages(lambda *one: told.append(one))
    trial = Trial(person, Path("walk1.c3d"))
    tasks = [
        ScalePerson(person, Path("out")),
        ReconstructTrial(trial, Path("s"), Path("out"), ReconstructSettings()),
    ]
    assert list(stages.named(tasks)) == tasks
    stages({0: Progress("Scaling", 1, 50), 1: Progress()})
    stages({1: Progress("Filtering", 20, 500)})
    stages({})
    assert told == [
        ("P1/monday: Scaling", 1, 50),
        ("P1/monday: Scaling", 50, 50),
        ("P1/monday/walk1: Filtering", 20, 500),
        ("P1/monday/walk1: Filtering", 500, 500),
    ]
