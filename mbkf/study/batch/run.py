"""A batch from end to end: a folder or a list in, a folder per trial and tables over all trials out."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence, Set
from dataclasses import replace
from os import cpu_count
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from mbkf.conventions import StageCallback
from mbkf.errors import FileFormatError, InvalidInput, MbkfWarning
from mbkf.io.atomic import check_folder
from mbkf.io.files_read import opened, own_files_read
from mbkf.io.leftovers import sweep_folder
from mbkf.study.batch.cluster import ClusterWorkers
from mbkf.study.batch.folder import plan_of_folder
from mbkf.study.batch.lists import plan_of_csv, plan_of_toml
from mbkf.study.batch.other_person import plan_of_others
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.plan import Person, Plan, Trial
from mbkf.study.batch.tables import TABLES, write_tables
from mbkf.study.batch.task_stages import TaskStages
from mbkf.study.batch.tasks import BatchTask, ReconstructTrial, ScalePerson, SortCaptures
from mbkf.study.batch.workers import Executor, LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

LISTS = {".toml": plan_of_toml, ".csv": plan_of_csv}


def batch(
    source: str | Path,
    out: str | Path,
    *,
    workers: int | None = None,
    dask: str | None = None,
    shard: tuple[int, int] | None = None,
    settings: ReconstructSettings | None = None,
    static_only: bool = False,
    progress: StageCallback | None = None,
) -> pa.Table:
    """Scales every person once and reconstructs every trial; finished and unchanged results are kept.

    Args:
        source: A folder of captures (:mod:`mbkf.study.batch.folder`), or a list of persons and trials in TOML or
            CSV (:mod:`mbkf.study.batch.lists`).
        out: Folder for the results: ``SUBJECT[/SESSION]/TRIAL``, and the tables ``summary`` and ``curves``, each as
            CSV and Parquet.
        workers: Processes, one thread each; by default as many as this computer has processors.
        dask: Address of a Dask scheduler whose workers do it instead; "local" for a cluster on this computer.
        shard: (I, N): only every N-th trial, from the I-th (from 1) on, for jobs that know nothing of each other.
        settings: The filter and its settings.
        static_only: Scale from the standing trial alone, where there is one; by default also from those of the
            session's other trials that help (:mod:`mbkf.study.scaling`).
        progress: Called with the stage ("Scaling", "Trials"), items done and items in all; also with each trial under
            way, as "P1/walk1: Filtering", frames done and frames in all.

    Returns:
        The table of trials: a row for each, with ``status``, ``reason`` and all of its ``summary.json``.

    Raises:
        FileFormatError: The list is damaged, or a file stands where a folder is needed.
        InvalidInput: No trial was found, the shard does not exist, or no scheduler answers.
        MissingDependency: Dask is not installed.
        OSError: The folder cannot be written to.
    """
    if workers is not None and workers < 1:
        raise InvalidInput(f"{workers} workers can do nothing; give one or more")
    target, plan = check_folder(out, TABLES), plan_of(Path(source))
    if static_only:
        plan = plan.from_standing()
    for note in plan.notes:
        warnings.warn(note, MbkfWarning, stacklevel=2)
    if shard is not None:
        plan = plan.shard(*shard)
    count = workers or cpu_count() or 1
    executor: Executor = LocalWorkers(count) if dask is None else ClusterWorkers(dask, count)
    suffix = "" if shard is None else f"-{shard[0]}-of-{shard[1]}"
    try:
        plan = sorted_plan(plan, executor, progress)
        return follow(plan, target, settings or ReconstructSettings(), executor, progress, suffix)
    finally:
        executor.close()
        sweep_plan(plan, target)


def follow(
    plan: Plan,
    out: Path,
    settings: ReconstructSettings,
    executor: Executor,
    progress: StageCallback | None = None,
    suffix: str = "",
) -> pa.Table:
    """Carries out a plan and makes its tables; returns that of the trials.

    Args:
        plan: The persons and trials.
        out: The batch's folder.
        settings: The filter and its settings.
        executor: Who does it.
        progress: Called with the stage, items done and items in all.
        suffix: Ends the tables' names.

    Raises:
        OSError: The folder cannot be written to.
    """
    out.mkdir(parents=True, exist_ok=True)
    outcomes = outcomes_of(plan, out, settings, executor, progress)
    if not suffix:  # a part of the trials may not hold all of another person
        plan, outcomes = with_others(plan, outcomes, out, settings, executor, progress)
    with own_files_read(), opened(write_tables(plan, outcomes, out, suffix)) as file:
        return pq.read_table(file)


def with_others(
    plan: Plan,
    outcomes: list[Outcome],
    out: Path,
    settings: ReconstructSettings,
    executor: Executor,
    progress: StageCallback | None = None,
) -> tuple[Plan, list[Outcome]]:
    """Plan and outcomes in which trials that do not show their person are done as another's, where they can be.

    Args:
        plan: The persons and trials.
        outcomes: Outcome of each trial.
        out: The batch's folder.
        settings: The filter and its settings.
        executor: Who does it.
        progress: Called with the stage, items done and items in all.
    """
    strange = [k for k, one in enumerate(outcomes) if one.another_person]
    if not strange:
        return plan, outcomes
    others = sorted_plan(plan_of_others([plan.trials[k] for k in strange]), executor, progress)
    others = _with_free_places(others, {one.place for one in plan.persons})
    trials, found = list(plan.trials), list(outcomes)
    try:
        done = outcomes_of(others, out, settings, executor, progress)
    finally:
        sweep_plan(others, out)
    for k, trial, one in zip(strange, others.trials, done, strict=True):
        if one.status != Status.FAILED:
            trials[k], found[k] = trial, one
    return Plan(tuple(trials), plan.notes), found


def _with_free_places(others: Plan, taken: Set[Path]) -> Plan:
    """The plan in which trials of persons whose place is taken have that as their fault."""
    trials = (
        replace(one, fault=f"{one.person.place} is another person's folder")
        if one.person.place in taken
        else one
        for one in others.trials
    )
    return Plan(tuple(trials), others.notes)


def plan_of(source: Path) -> Plan:
    """The persons and trials of a folder or list.

    Raises:
        FileFormatError: It is neither, or damaged.
        InvalidInput: It holds no trial.
    """
    if source.is_dir():
        return plan_of_folder(source)
    if source.suffix.lower() not in LISTS:
        raise FileFormatError(source, "is neither a folder nor a list in TOML or CSV")
    return LISTS[source.suffix.lower()](source)


def sorted_plan(plan: Plan, executor: Executor, progress: StageCallback | None = None) -> Plan:
    """The plan with captures that nothing states the person of sorted by their movements.

    Args:
        plan: The persons and trials.
        executor: Who compares the captures.
        progress: Called with the stage, items done and items in all.
    """
    persons = [person for person in plan.persons if person.unsorted]
    if not persons:
        return plan
    found = _done([SortCaptures(person) for person in persons], executor, "Sorting", progress)
    return plan.with_persons(
        {
            person: f"its captures could not be compared: {one.reason}"
            if one.captures is None
            else one.captures
            for person, one in zip(persons, found, strict=True)
        }
    )


def sweep_plan(plan: Plan, out: Path) -> None:
    """Removes the unfinished files and folders that killed workers left.

    Args:
        plan: The persons and trials.
        out: The batch's folder.
    """
    places = {out / trial.place for trial in plan.trials}
    for place in places | {place.parent for place in places} | {out / one.place for one in plan.persons}:
        sweep_folder(place)


def outcomes_of(
    plan: Plan,
    out: Path,
    settings: ReconstructSettings,
    executor: Executor,
    progress: StageCallback | None = None,
) -> list[Outcome]:
    """Outcome of each trial: persons are scaled first.

    Args:
        plan: The persons and trials.
        out: The batch's folder.
        settings: The filter and its settings.
        executor: Who does it.
        progress: Called with the stage, items done and items in all.
    """
    persons = plan.persons
    scaled = dict(
        zip(
            persons,
            _done([ScalePerson(person, out) for person in persons], executor, "Scaling", progress),
            strict=True,
        )
    )
    possible = [trial for trial in plan.trials if not trial.fault]
    ready = [trial for trial in possible if scaled[trial.person].subject is not None]
    tasks = (ReconstructTrial(one, _subject(scaled, one.person), out, settings) for one in ready)
    found = dict(zip(ready, _done(tasks, executor, "Trials", progress, len(ready)), strict=True))
    outcomes = [found.get(trial) or _undone(trial, scaled) for trial in plan.trials]
    return [
        replace(one, doubts="; ".join(filter(None, (_doubts(trial.person, scaled), one.doubts))))
        for trial, one in zip(plan.trials, outcomes, strict=True)
    ]


def _doubts(person: Person, scaled: dict[Person, Outcome]) -> str:
    """Doubts about a trial's person; those of the plan where the person was not scaled."""
    outcome = scaled.get(person)
    known = outcome is not None and outcome.status != Status.FAILED
    return outcome.doubts if outcome is not None and known else "; ".join(person.remarks)


def _done(
    tasks: Iterable[BatchTask],
    executor: Executor,
    stage: str,
    progress: StageCallback | None,
    count: int | None = None,
) -> list[Outcome]:
    """Outcomes in the order of their tasks.

    Args:
        tasks: They.
        executor: Who does them.
        stage: Name of the stage, for the progress.
        progress: Called with the stage, items done and items in all.
        count: How many there are, where the tasks have no length.
    """
    total = len(tasks) if isinstance(tasks, Sequence) else count or 0
    found: dict[int, Outcome] = {}
    inside = None if progress is None else TaskStages(progress)
    for number, outcome in executor.run(tasks if inside is None else inside.named(tasks), inside):
        found[number] = outcome
        if progress is not None:
            progress(stage, len(found), total)
    return [found[number] for number in range(total)]


def _subject(scaled: dict[Person, Outcome], person: Person) -> Path:
    subject = scaled[person].subject
    assert subject is not None, "only trials of scaled persons are done"
    return subject


def _undone(trial: Trial, scaled: dict[Person, Outcome]) -> Outcome:
    if trial.fault:
        return Outcome(Status.FAILED, trial.fault)
    return Outcome(Status.FAILED, f"the person could not be scaled: {scaled[trial.person].reason}")
