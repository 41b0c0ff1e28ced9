"""A study as a laboratory keeps it: walks of synthetic persons with their standing trials, made once."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pyarrow as pa
import pytest

from mbkf.scaling.records import ScalingSettings
from mbkf.study.batch.progress import Progress
from mbkf.study.batch.run import follow, plan_of, sorted_plan
from mbkf.study.scaling.session import scale_from_session
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise, write_folder

SECONDS = 2.5
QUICK = ReconstructSettings(filter="kinematic", smooth=False)
"""A filter for tests that ask nothing of the estimates."""


@cache
def walk_folder() -> Path:
    """A synthetic walk as `mbkf synth` writes it: trial.c3d, static.c3d, subject.toml, truth.h5."""
    folder = Path(mkdtemp(prefix="mbkf-study-"))
    person, made = synthesise("walk", seconds=SECONDS)
    write_folder(person, made, folder)
    return folder


class ThisProcess:
    """An executor without workers: tasks are done in order, where they are asked for."""

    def __init__(self, workers: int = 1) -> None:
        self.workers = workers

    def run(self, tasks, watch=None):
        for number, task in enumerate(tasks):
            if watch is None:
                yield number, task()
            else:
                yield number, task(lambda *stage, at=number: watch({at: Progress(*stage)}))

    def close(self):
        pass


def batch_here(
    source: Path, out: Path, settings: ReconstructSettings = QUICK, static_only: bool = False
) -> pa.Table:
    """A batch without workers."""
    plan = plan_of(source)
    plan = sorted_plan(plan.from_standing() if static_only else plan, ThisProcess())
    return follow(plan, out, settings, ThisProcess())


@contextmanager
def runs_here() -> Iterator[None]:
    """Runs of the laboratory's page are quick, in a thread of this process; bodies are those of the static."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mbkf.app.runs.LocalWorkers", ThisProcess)
        patch.setattr("mbkf.app.runs.ReconstructSettings", lambda: QUICK)
        patch.setattr("mbkf.study.batch.person.scale_from_session", from_standing)
        yield


def from_standing(static, others, scaling, settings=None, progress=None):
    """The body of a session by its standing trial under the names in the file, whatever else the session holds."""
    del others
    named = replace(settings or ScalingSettings(), correct_names=False)
    return scale_from_session(static, (), scaling, named, progress)


def study(folder: Path, persons: int = 1, trials: int = 1) -> Path:
    """A folder of persons P1, P2, … with walk1.c3d, walk2.c3d, … and static.c3d each; returns it."""
    for person in range(1, persons + 1):
        own = folder / f"P{person}"
        own.mkdir(parents=True)
        (own / "static.c3d").write_bytes((walk_folder() / "static.c3d").read_bytes())
        for trial in range(1, trials + 1):
            (own / f"walk{trial}.c3d").write_bytes((walk_folder() / "trial.c3d").read_bytes())
    return folder
