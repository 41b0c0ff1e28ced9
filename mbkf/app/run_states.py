"""States of the runs of sessions, and their file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mbkf.io.files_read import read_state
from mbkf.study.batch.progress import Progress

WAITING, RUNNING, FINISHED, CANCELLED, FAILED = "waiting", "running", "finished", "cancelled", "failed"

NOT_READY = "not_ready"
"""State of a session that was left out when all sessions were queued; its reason says why."""

INCOMPLETE = frozenset({CANCELLED, FAILED, NOT_READY})
"""States whose session has trials that were not done."""


@dataclass
class RunState:
    """The state of a session's run.

    Attributes:
        state: "waiting", "running", "finished", "cancelled", "failed" or "not_ready".
        stage: "scaled" or "trials".
        done, total: Counts of trials.
        seconds: Time since the run began.
        scaled_s: Time until the person was scaled.
        reason: Cause of a failure of the whole run, or for which the session is not ready; empty without.
        persons: Files of each person, by place, where the failure is that there are several; empty otherwise.
        trials: Status of each trial by name ("done", "unchanged" or "failed"), and its reason.
        under_way: Progress of each trial under way by name; of the scaling under "".
    """

    state: str = WAITING
    stage: str = ""
    done: int = 0
    total: int = 0
    seconds: float = 0.0
    scaled_s: float = 0.0
    reason: str = ""
    persons: dict[str, list[str]] = field(default_factory=dict)
    trials: dict[str, tuple[str, str]] = field(default_factory=dict)
    under_way: dict[str, Progress] = field(default_factory=dict)

    @property
    def remaining_s(self) -> float | None:
        """Estimated time until the end, s; None before the first trial is being filtered."""
        if self.state != RUNNING or not self.total:
            return None
        share = (self.done + self.share) / self.total
        return None if share <= 0.0 else (self.seconds - self.scaled_s) / share * max(1.0 - share, 0.0)

    @property
    def share(self) -> float:
        """Shares of the trials under way that are done, added up."""
        return sum(one.share for one in self.under_way.values())


def read_states(file: Path) -> dict[str, RunState]:
    """The states in a file; empty if it is missing or damaged."""
    try:
        plain = json.loads(read_state(file))
        return {str(name): state_of(one) for name, one in plain.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def state_of(plain: Mapping[str, object]) -> RunState:
    """A state from plain data, without trials under way.

    Raises:
        ValueError, TypeError, AttributeError: The data are no state.
    """
    state = RunState(**plain)  # type: ignore[arg-type]
    state.trials = {str(k): (str(a), str(b)) for k, (a, b) in state.trials.items()}
    state.persons = {str(k): [str(name) for name in names] for k, names in state.persons.items() if names}
    state.under_way = {}
    return state
