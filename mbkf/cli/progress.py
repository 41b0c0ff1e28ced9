"""Progress bars on stderr for work that takes a while; silent when stderr is not a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from mbkf.conventions import StageCallback

if TYPE_CHECKING:
    from rich.progress import TaskID

Advance = Callable[[int], None]
"""Tells how many more items are done."""


@contextmanager
def progress(title: str, total: int) -> Iterator[Advance]:
    """One bar for one piece of work.

    Used as ``with progress("Filtering", frames) as advance:`` with ``advance(1)`` after each frame.

    Args:
        title: What is being done.
        total: Number of items.

    Yields:
        A function that takes the number of items just finished.
    """
    with stages() as report:
        done = 0

        def advance(count: int = 1) -> None:
            nonlocal done
            done += count
            report(title, done, total)

        report(title, 0, total)
        yield advance


@contextmanager
def stages() -> Iterator[StageCallback]:
    """The bars of a pipeline, one per stage.

    Used as ``with stages() as report:`` around a call that is given ``progress=report``.

    Yields:
        The callback a pipeline takes as ``progress``; a stage's bar appears when it first reports.
    """
    if not sys.stderr.isatty():
        yield _ignore
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        tasks: dict[str, TaskID] = {}

        def report(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage, total=total)
            bars.update(tasks[stage], completed=done, total=total)

        yield report


def _ignore(_stage: str, _done: int, _total: int) -> None:
    """Takes progress reports that are not shown."""
