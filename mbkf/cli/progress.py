"""Progress bars on stderr for work that takes a while; silent when stderr is not a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from mbkf.cli.terminal import console
from mbkf.conventions import StageCallback

if TYPE_CHECKING:
    from rich.progress import TaskID


@contextmanager
def stages() -> Iterator[StageCallback]:
    """Shows a bar for each stage of the work: the yielded callback is passed on as ``progress``.

    Yields:
        The callback; a stage's bar appears when it first reports, and goes after its stage, when the next one begins.
    """
    if not sys.stderr.isatty():
        yield _ignore
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console(stderr=True), transient=True) as bars:
        tasks: dict[str, TaskID] = {}

        def report(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                for bar in [one for one in bars.tasks if one.finished]:
                    bars.remove_task(bar.id)
                    tasks.pop(bar.description)
                tasks[stage] = bars.add_task(stage, total=total)
            bars.update(tasks[stage], completed=done, total=total)

        yield report


def _ignore(_stage: str, _done: int, _total: int) -> None:
    """Takes progress reports that are not shown."""
