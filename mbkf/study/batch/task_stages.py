"""Stages of tasks under way as stages of a batch: "P1/walk1: Filtering", frames done, frames in all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from mbkf.conventions import StageCallback
from mbkf.study.batch.progress import Progress
from mbkf.study.batch.tasks import BatchTask


class TaskStages:
    """Reports the stages of tasks; a stage that is left is reported as done.

    Args:
        report: Called with the stage, items done and items in all.
    """

    def __init__(self, report: StageCallback) -> None:
        self._report = report
        self._names: list[str] = []
        self._open: dict[str, int] = {}

    def named(self, tasks: Iterable[BatchTask]) -> Iterator[BatchTask]:
        """The tasks; their names are noted as they are asked for."""
        for task in tasks:
            self._names.append(task.name)
            yield task

    def __call__(self, under_way: Mapping[int, Progress]) -> None:
        """Reports progress.

        Args:
            under_way: Progress of the tasks by their places in the order given.
        """
        shown = {f"{self._names[number]}: {one.stage}": one for number, one in under_way.items() if one.stage}
        for stage in [stage for stage in self._open if stage not in shown]:
            total = self._open.pop(stage)
            self._report(stage, total, total)
        for stage, one in shown.items():
            self._open[stage] = one.total
            self._report(stage, one.done, one.total)
