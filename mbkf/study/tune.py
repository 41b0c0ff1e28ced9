"""Tunes the noise settings of a filter: those under which the innovations of trials are most probable.

The likelihood takes readings of successive frames to err independently. Skin does not, so its optimum need not be
best for torques. Measured on synthetic trials (1 mm cameras, 5 mm skin; seeds 1 and 2), RMS error of joint torques in
N m with the defaults → tuned on the trial's first half:

| | walk | squat | jump |
|---|---|---|---|
| kinematic | 13.3 → 7.0, 15.0 → 7.0 | 11.5 → 2.2, 13.9 → 2.8 | 12.2 → 7.3, 15.0 → 8.8 |
| dynamic | 2.8 → 3.4, 2.8 → 3.2 | 1.1 → 1.0, 1.5 → 1.3 | 4.3 → 4.8, 5.3 → 5.9 |
| dynamic, smoothed | 1.6 → 2.0, 1.6 → 1.5 | 0.9 → 0.7, 1.1 → 0.8 | 1.6 → 2.0, 1.9 → 2.4 |

On seed 0, tuning the share of independent readings, too, makes readings more probable by 0.5 nats each and the dynamic
filter's torques worse (squat 1.4 → 1.9 N m, walk 3.2 → 3.5), so it is left alone by default. How exactly Newton's law
holds is not determined by innovations, and the noise of plates hardly.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.filters.given_settings import own_values
from mbkf.filters.settings import flat
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.line_search import maximise
from mbkf.numerics.threads import single_threaded
from mbkf.study.tuning.parameters import PARAMETERS, TuningParameter, parameter_names
from mbkf.study.tuning.result import FLAT_FACTOR, Tuned, TunedParameter
from mbkf.study.tuning.trial_parts import TrialPart, likelihood_per_reading, split_trials
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.preparation.settings import ReconstructSettings


@dataclass(frozen=True)
class TuneSettings:
    """Settings of the tuning of a filter.

    Attributes:
        filter: "dynamic" or "kinematic".
        parameters: Names of :data:`PARAMETERS`; None: the default ones.
        hold_out: Positions of the held-out trials; None: the last of several, or the second half of one.
        calls: Most runs over the trials in the search.
        reconstruct: Settings to start from.
    """

    filter: str = "dynamic"
    parameters: tuple[str, ...] | None = None
    hold_out: tuple[int, ...] | None = None
    calls: int = 60
    reconstruct: ReconstructSettings = field(default_factory=ReconstructSettings)


def tune(
    captures: Sequence[Capture],
    subject: Subject,
    *,
    settings: TuneSettings | None = None,
    progress: StageCallback | None = None,
) -> Tuned:
    """Settings under which the innovations of trials are most probable, and their likelihood on held-out readings.

    Args:
        captures: Trials of one subject.
        subject: The scaled person.
        settings: Filter, parameters and held-out trials.
        progress: Called with the stage, items done and items in all.

    Raises:
        UnknownName: The filter or a parameter does not exist.
        InvalidInput: A trial is too short, every trial is held out, or the axes of one cannot be right.
        NotObservable: The markers do not determine the body.
        NotConverged: The markers do not fit the subject's body.
    """
    settings = settings or TuneSettings()
    begin = time.perf_counter()
    names = parameter_names(settings.filter, settings.parameters)
    report = progress or (lambda *_: None)
    with single_threaded():
        captures = [checked_for_subject(capture, subject) for capture in captures]
        learn, held_out = split_trials(
            captures, subject, settings.filter, settings.reconstruct, settings.hold_out
        )
        known = PARAMETERS[settings.filter]
        base = getattr(settings.reconstruct, settings.filter)
        objective = _Objective(
            learn, [known[n] for n in names], base, settings.calls + 2 * len(names), report
        )
        low = np.log([known[name].lowest for name in names])
        high = np.log([known[name].highest for name in names])
        found = maximise(objective, np.zeros(len(names)), low, high, calls=settings.calls)
        parameters = tuple(
            TunedParameter(
                name,
                math.exp(found.x[i]),
                _cost(objective, found.x, found.value, i),
                bool(min(found.x[i] - low[i], high[i] - found.x[i]) < 1e-6),
            )
            for i, name in enumerate(names)
        )
        x = np.where([one.determined for one in parameters], found.x, 0.0)
        report("Tuning", objective.runs, objective.runs)
        defaults, values = objective.values(np.zeros(len(names))), objective.values(x)
        likelihood = {}
        for name, parts in (("tuned", learn), ("held_out", held_out)):
            for when, there in (("before", defaults), ("after", values)):
                likelihood[f"{name}_{when}"] = likelihood_per_reading(parts, there)
    return Tuned(
        settings.filter,
        parameters,
        values,
        defaults,
        likelihood,
        tuple(dict.fromkeys(one.name for one in learn)),
        tuple(dict.fromkeys(one.name for one in held_out)),
        objective.runs,
        found.settled,
        time.perf_counter() - begin,
        {key: value for key, value in own_values(base).items() if key not in values},
    )


class _Objective:
    """Log-likelihood of all trials as a function of the logarithms of the factors."""

    def __init__(
        self,
        parts: Sequence[TrialPart],
        parameters: Sequence[TuningParameter],
        base: Any,
        most: int,
        report: Callable[[str, int, int], None],
    ) -> None:
        self._parts, self._parameters = parts, parameters
        self._base: Any = flat(base)
        self._most, self._report = most, report
        self.runs = 0

    def __call__(self, x: Array) -> float:
        values = self.values(x)
        total = sum(part.value(values) for part in self._parts)
        self.runs += 1
        self._report("Tuning", self.runs, self._most)
        return total

    def values(self, x: Array) -> dict[str, float]:
        """Settings by name, to three digits."""
        return {
            name: float(f"{self._base[name] * math.exp(power):.3g}")
            for one, power in zip(self._parameters, x, strict=True)
            for name in one.fields
        }


def _cost(objective: _Objective, x: Array, here: float, i: int) -> float:
    """Nats by which a factor of ``FLAT_FACTOR`` on one parameter changes the likelihood at least."""
    there = []
    for sign in (1.0, -1.0):
        moved = x.copy()
        moved[i] += sign * math.log(FLAT_FACTOR)
        there.append(objective(moved))
    return min(abs(value - here) for value in there)
