"""Progress inside a task: its stage, and its share of a trial's time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

READING, MARKERS, FILTERING, WRITING = "Reading", "Following markers alone", "Filtering", "Writing"
"""Stages of a trial; those in the middle are named by :func:`mbkf.trial.reconstruct.reconstruct`."""

SHARES = {READING: 0.02, MARKERS: 0.20, FILTERING: 0.70, WRITING: 0.08}
"""Share of a trial's time that each stage takes, in their order; estimated, for the time left that is shown."""


@dataclass(frozen=True)
class Progress:
    """Progress of a task.

    Attributes:
        stage: Name of its stage; empty before the first one.
        done: Items done in the stage, such as frames.
        total: Items of the stage in all.
    """

    stage: str = ""
    done: int = 0
    total: int = 0

    @property
    def share(self) -> float:
        """Share of a trial's time that has passed, 0 to 1; 0 in a stage that is not a trial's."""
        if self.stage not in SHARES:
            return 0.0
        stages = list(SHARES)
        before = sum(SHARES[stage] for stage in stages[: stages.index(self.stage)])
        return before + SHARES[self.stage] * (min(self.done / self.total, 1.0) if self.total > 0 else 0.0)


Watch = Callable[[Mapping[int, Progress]], None]
"""Called several times a second with the progress of all tasks under way, by their places in the order given. An error
that it raises ends the run and all tasks under way."""


def ignored(*_progress: str | int) -> None:
    """Takes progress that nobody shows."""
