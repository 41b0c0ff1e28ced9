"""Finds what a filter should believe of noise: the settings under which trials' innovations are most probable.

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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array, BoolArray, StageCallback
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.filters.estimate import Recording
from mbkf.filters.likelihood import TrialLikelihood, trial_likelihood
from mbkf.filters.settings import changed, flat
from mbkf.io.preset import Preset
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.line_search import maximise
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.reconstruct import ReconstructSettings, subject_markers
from mbkf.pipelines.trial.followers import FilterInputs, follower
from mbkf.pipelines.trial.inputs import trial_inputs
from mbkf.scaling.correction import correct_markers
from mbkf.version import __version__

SETTLING_S = 0.5
"""Time after a start in which innovations are not judged."""

LEAST_S = 0.25
"""Shortest stretch worth judging."""

FLAT_NATS = 2.0
"""A parameter is not determined if a factor of ``FLAT_FACTOR`` either way costs less than this."""

FLAT_FACTOR = 1.5


@dataclass(frozen=True)
class Parameter:
    """Settings of a filter that are scaled together.

    Attributes:
        fields: The settings.
        lowest, highest: Range of the factor on their defaults.
        default: Whether it is tuned unless others are named.
        about: What it is.
    """

    fields: tuple[str, ...]
    lowest: float
    highest: float
    default: bool
    about: str


PARAMETERS: Mapping[str, Mapping[str, Parameter]] = {
    "dynamic": {
        "motion": Parameter(("acceleration_scale",), 0.1, 10.0, True, "how much the body accelerates"),
        "loads": Parameter(("wrench_force", "wrench_moment"), 0.02, 20.0, True, "how fast foot loads change"),
        "plates": Parameter(("plate_force_n", "plate_moment_nm"), 0.1, 10.0, True, "noise of the plates"),
        "law": Parameter(
            ("residual_force_n", "residual_moment_nm"), 0.1, 10.0, False, "how exactly Newton's law holds"
        ),
        "share": Parameter(("innovation_share",), 0.2, 10.0, False, "innovations over markers' noise"),
        "markers": Parameter(("marker_noise_scale",), 0.2, 5.0, False, "noise of the markers"),
    },
    "kinematic": {
        "motion": Parameter(("acceleration_scale",), 0.05, 20.0, True, "how much the body accelerates"),
        "markers": Parameter(("marker_noise_scale",), 0.1, 5.0, True, "noise of the markers"),
    },
}
"""What can be tuned, by filter and name."""


@dataclass(frozen=True)
class TuneSettings:
    """How a filter is tuned.

    Attributes:
        filter: "dynamic" or "kinematic".
        parameters: Names of :data:`PARAMETERS`; None for the default ones.
        hold_out: Positions of the trials that only judge; None for the last of several, or the second half of one.
        calls: Most runs over the trials in the search.
        reconstruct: Settings to start from.
    """

    filter: str = "dynamic"
    parameters: tuple[str, ...] | None = None
    hold_out: tuple[int, ...] | None = None
    calls: int = 60
    reconstruct: ReconstructSettings = field(default_factory=ReconstructSettings)


@dataclass(frozen=True)
class TunedParameter:
    """What became of a parameter: its factor, and by how many nats a factor of 1.5 either way tells."""

    name: str
    factor: float
    cost_nats: float
    at_bound: bool

    @property
    def determined(self) -> bool:
        """Whether the trials say anything about it."""
        return self.cost_nats >= FLAT_NATS


@dataclass(frozen=True)
class Tuned:
    """Result of tuning.

    Attributes:
        filter: Which filter.
        parameters: What became of each.
        values: Settings found; those of parameters that are not determined are the defaults.
        defaults: What they were.
        likelihood: Nats per reading: "tuned_before", "tuned_after", "held_out_before", "held_out_after".
        tuned_on, held_out: Names of the trials.
        calls: Runs over the trials.
        settled: Whether the search had ended by itself.
        seconds: Time it took.
    """

    filter: str
    parameters: tuple[TunedParameter, ...]
    values: Mapping[str, float]
    defaults: Mapping[str, float]
    likelihood: Mapping[str, float]
    tuned_on: tuple[str, ...]
    held_out: tuple[str, ...]
    calls: int
    settled: bool
    seconds: float

    @property
    def better(self) -> bool:
        """Whether the held-out readings are more probable than with the defaults."""
        return self.likelihood["held_out_after"] > self.likelihood["held_out_before"]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a person should know."""
        said = []
        if not self.better:
            said.append(
                "held-out readings are no more probable with what was found, so the preset keeps the defaults"
            )
        for one in self.parameters:
            if not one.determined:
                said.append(f"'{one.name}' is not determined by these trials and keeps its default")
            elif one.at_bound:
                said.append(f"'{one.name}' ended at the bound of its range")
        if not self.settled:
            said.append("the search used up its runs before it settled; give it more with --runs")
        return tuple(said)

    def preset(self, name: str) -> Preset:
        """The preset to save: what was found, or the defaults where that was no better on held-out readings."""
        return Preset(
            name,
            self.filter,
            self.values if self.better else self.defaults,
            __version__,
            "; ".join(self.warnings),
            self.tuned_on,
            self.held_out,
            {} if self.better else self.values,
            self.likelihood,
        )


def tune(
    captures: Sequence[Capture],
    subject: Subject,
    *,
    settings: TuneSettings | None = None,
    progress: StageCallback | None = None,
) -> Tuned:
    """Settings under which the innovations of trials are most probable, and what held-out readings say of them.

    Args:
        captures: Trials of one subject.
        subject: The scaled person.
        settings: How.
        progress: Called with the stage, items done and items in all.

    Raises:
        UnknownName: The filter or a parameter does not exist.
        InvalidInput: A trial is too short, or none is left to learn from.
        NotObservable: The markers do not follow the body.
        NotConverged: The markers do not fit the subject's body.
    """
    settings = settings or TuneSettings()
    begin = time.perf_counter()
    names = _names(settings)
    report = progress or (lambda *_: None)
    with single_threaded():
        learn, judge = _split(captures, subject, settings)
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
        for part, stretches in (("tuned", learn), ("held_out", judge)):
            for when, there in (("before", defaults), ("after", values)):
                likelihood[f"{part}_{when}"] = _per_reading(stretches, there)
    return Tuned(
        settings.filter,
        parameters,
        values,
        defaults,
        likelihood,
        tuple(dict.fromkeys(one.name for one in learn)),
        tuple(dict.fromkeys(one.name for one in judge)),
        objective.runs,
        found.settled,
        time.perf_counter() - begin,
    )


class _Stretch:
    """A trial, or a part of it, that the likelihood is taken of, and what the defaults make of it."""

    def __init__(self, name: str, kind: str, inputs: FilterInputs, recording: Recording, since: int) -> None:
        self.name, self._kind, self._inputs, self._recording = name, kind, inputs, recording
        self._reference = self._run(inputs)
        if self._reference.first == len(recording):
            raise NotObservable(f"trial '{name}': in no frame do the markers fit the scaled body")
        settled = self._reference.first + round(SETTLING_S / inputs.dt_s)
        self._judged: BoolArray = np.arange(len(recording)) >= max(since, settled)
        if self._judged.sum() * inputs.dt_s < LEAST_S:
            raise InvalidInput(
                f"trial '{name}' is too short to tune on: of {len(recording) * inputs.dt_s:.2g} s too little is left "
                f"after {SETTLING_S:g} s of settling (a single trial is halved)"
            )
        readings = self._reference.marker_readings + self._reference.load_readings
        self.readings = int(readings[self._judged].sum())

    def value(self, values: Mapping[str, float]) -> float:
        """Log-likelihood with other settings, nats; −inf where the filter diverges.

        Frames whose feet are taken to stand on something else than with the defaults have other readings; their loads
        count as unchanged.
        """
        changes: dict[str, Any] = {self._kind: changed(getattr(self._inputs, self._kind), **values)}
        try:
            with np.errstate(all="ignore"):
                found = self._run(replace(self._inputs, **changes))
        except (np.linalg.LinAlgError, ValueError):
            return -math.inf
        same = found.load_readings == self._reference.load_readings
        total = found.markers + np.where(same, found.loads, self._reference.loads)
        value = float(total[self._judged].sum())
        return value if math.isfinite(value) else -math.inf

    def _run(self, inputs: FilterInputs) -> TrialLikelihood:
        return trial_likelihood(follower(self._kind, inputs), self._recording)


class _Objective:
    """Log-likelihood of all trials as a function of the logarithms of the factors."""

    def __init__(
        self,
        stretches: Sequence[_Stretch],
        parameters: Sequence[Parameter],
        base: Any,
        most: int,
        report: Callable[[str, int, int], None],
    ) -> None:
        self._stretches, self._parameters = stretches, parameters
        self._base: Any = flat(base)
        self._most, self._report = most, report
        self.runs = 0

    def __call__(self, x: Array) -> float:
        values = self.values(x)
        total = sum(stretch.value(values) for stretch in self._stretches)
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


def _names(settings: TuneSettings) -> tuple[str, ...]:
    if settings.filter not in PARAMETERS:
        raise UnknownName("filter to tune", settings.filter, PARAMETERS)
    known = PARAMETERS[settings.filter]
    if settings.parameters is None:
        return tuple(name for name, one in known.items() if one.default)
    for name in settings.parameters:
        if name not in known:
            raise UnknownName("parameter", name, known, "--parameters")
    if not settings.parameters:
        raise InvalidInput("--parameters: name at least one of " + ", ".join(known))
    return tuple(dict.fromkeys(settings.parameters))


def _inputs(
    capture: Capture, subject: Subject, settings: ReconstructSettings
) -> tuple[FilterInputs, Recording]:
    """The whole trial, nothing hidden or withheld."""
    shown = subject_markers(capture.markers, subject)
    if settings.correct_markers:
        subject = correct_markers(subject, shown)
    return trial_inputs(shown, capture.plates, subject, settings)


def _split(
    captures: Sequence[Capture], subject: Subject, settings: TuneSettings
) -> tuple[list[_Stretch], list[_Stretch]]:
    """Stretches to learn from, and those that judge."""
    count = len(captures)
    if not count:
        raise InvalidInput("tuning needs at least one trial")
    kind = settings.filter
    made = [_inputs(capture, subject, settings.reconstruct) for capture in captures]
    names = [Path(capture.path).stem or f"trial {i + 1}" for i, capture in enumerate(captures)]
    if count == 1 and not settings.hold_out:
        (inputs, whole), half = made[0], len(made[0][1]) // 2
        first = Recording(whole.markers_m[:half], whole.plates[:half], whole.dt_s)
        return (
            [_stretch(f"{names[0]}, first half", kind, inputs, first, 0)],
            [_stretch(f"{names[0]}, second half", kind, inputs, whole, half)],
        )
    out = (count - 1,) if settings.hold_out is None else settings.hold_out
    if len(set(out)) >= count:
        raise InvalidInput("every trial is held out, so none is left to tune on")
    made_of = [_stretch(name, kind, *one, 0) for name, one in zip(names, made, strict=True)]
    judge = [stretch for i, stretch in enumerate(made_of) if i in out]
    return [stretch for i, stretch in enumerate(made_of) if i not in out], judge


def _stretch(name: str, kind: str, inputs: FilterInputs, recording: Recording, since: int) -> _Stretch:
    try:
        return _Stretch(name, kind, inputs, recording, since)
    except np.linalg.LinAlgError as error:
        raise NotObservable(f"trial '{name}': the {kind} filter diverges with its defaults") from error


def _cost(objective: _Objective, x: Array, here: float, i: int) -> float:
    """Nats by which a factor of ``FLAT_FACTOR`` on one parameter changes the likelihood at least."""
    there = []
    for sign in (1.0, -1.0):
        moved = x.copy()
        moved[i] += sign * math.log(FLAT_FACTOR)
        there.append(objective(moved))
    return min(abs(value - here) for value in there)


def _per_reading(stretches: Sequence[_Stretch], values: Mapping[str, float]) -> float:
    total = sum(stretch.value(values) for stretch in stretches)
    return total / sum(stretch.readings for stretch in stretches)
