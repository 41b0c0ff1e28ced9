"""The likelihood of a trial, or of a part of it, as a function of a filter's settings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.errors import InvalidInput, NotObservable
from mbkf.filters.estimate import Recording
from mbkf.filters.likelihood import TrialLikelihood, trial_likelihood
from mbkf.filters.settings import changed
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.scaling.correction import correct_markers
from mbkf.trial.preparation.filters import FilterInputs, tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.preparation.static_names import markers_as_scaled

SETTLING_S = 0.5
"""Innovations within this time after a start of the filter are left out."""

LEAST_S = 0.25
"""Shortest part that a likelihood is taken of."""

MOST_LOST = 0.1
"""Where a larger share of the frames that are followed under the defaults is not with other settings, the filter
diverges."""


class TrialPart:
    """A trial, or a part of it, with its likelihood under the defaults as the reference.

    Attributes:
        name: Name of the trial.
        readings: Number of readings that the likelihood is taken of.
    """

    def __init__(self, name: str, kind: str, inputs: FilterInputs, recording: Recording, since: int) -> None:
        """Runs the filter once with the defaults.

        Args:
            name: Name of the trial.
            kind: Name of the filter.
            inputs: Inputs of the filter.
            recording: Readings of the trial.
            since: First frame that counts.

        Raises:
            NotObservable: The filter does not start, or diverges with its defaults.
            InvalidInput: The part is too short.
        """
        self.name, self._kind, self._inputs, self._recording = name, kind, inputs, recording
        try:
            self._reference = self._run(inputs)
        except np.linalg.LinAlgError as error:
            raise NotObservable(f"trial '{name}': the {kind} filter diverges with its defaults") from error
        if self._reference.first == len(recording):
            raise NotObservable(f"trial '{name}': in no frame do the markers fit the scaled body")
        settled = self._reference.first + round(SETTLING_S / inputs.dt_s)
        self._counted: BoolArray = np.arange(len(recording)) >= max(since, settled)
        if self._counted.sum() * inputs.dt_s < LEAST_S:
            raise InvalidInput(
                f"trial '{name}' is too short to tune on: of {len(recording) * inputs.dt_s:.2g} s too little is left "
                f"after {SETTLING_S:g} s of settling (a single trial is halved)"
            )
        readings = self._reference.marker_readings + self._reference.load_readings
        self.readings = int(readings[self._counted].sum())

    def value(self, values: Mapping[str, float]) -> float:
        """Log-likelihood with other settings, nats; −inf where the filter diverges.

        Frames whose foot contacts differ from those under the defaults have other readings; their loads count as
        unchanged.
        """
        changes: dict[str, Any] = {self._kind: changed(getattr(self._inputs, self._kind), **values)}
        try:
            with np.errstate(all="ignore"):
                found = self._run(replace(self._inputs, **changes))
        except (np.linalg.LinAlgError, ValueError):
            return -math.inf
        lost = self._reference.followed & ~found.followed & self._counted
        if lost.sum() > MOST_LOST * self._counted.sum():
            return -math.inf
        same = found.load_readings == self._reference.load_readings
        total = found.markers + np.where(same, found.loads, self._reference.loads)
        value = float(total[self._counted].sum())
        return value if math.isfinite(value) else -math.inf

    def _run(self, inputs: FilterInputs) -> TrialLikelihood:
        return trial_likelihood(tracking_filter(self._kind, inputs), self._recording)


def split_trials(
    captures: Sequence[Capture],
    subject: Subject,
    filter_name: str,
    settings: ReconstructSettings,
    hold_out: tuple[int, ...] | None,
) -> tuple[list[TrialPart], list[TrialPart]]:
    """Trials to tune on, and held-out trials; a single trial is halved.

    Args:
        captures: Trials of one subject.
        subject: The scaled person.
        filter_name: Name of the filter.
        settings: Settings of the reconstruction.
        hold_out: Positions of the held-out trials; None: the last of several, or the second half of one.

    Raises:
        InvalidInput: No trial is given, every trial is held out, or one is too short.
        NotObservable: The markers do not determine the body.
    """
    count = len(captures)
    if not count:
        raise InvalidInput("tuning needs at least one trial")
    made = [_inputs(capture, subject, settings) for capture in captures]
    names = [Path(capture.path).stem or f"trial {i + 1}" for i, capture in enumerate(captures)]
    if count == 1 and not hold_out:
        (inputs, whole), half = made[0], len(made[0][1]) // 2
        first = Recording(whole.markers_m[:half], whole.plates[:half], whole.dt_s)
        return (
            [TrialPart(f"{names[0]}, first half", filter_name, inputs, first, 0)],
            [TrialPart(f"{names[0]}, second half", filter_name, inputs, whole, half)],
        )
    out = (count - 1,) if hold_out is None else hold_out
    if len(set(out)) >= count:
        raise InvalidInput("every trial is held out; leave at least one to tune on")
    parts = [TrialPart(name, filter_name, *one, 0) for name, one in zip(names, made, strict=True)]
    return [part for i, part in enumerate(parts) if i not in out], [
        part for i, part in enumerate(parts) if i in out
    ]


def likelihood_per_reading(parts: Sequence[TrialPart], values: Mapping[str, float]) -> float:
    """Log-likelihood per reading over several parts, nats."""
    return sum(part.value(values) for part in parts) / sum(part.readings for part in parts)


def _inputs(
    capture: Capture, subject: Subject, settings: ReconstructSettings
) -> tuple[FilterInputs, Recording]:
    """Inputs and readings of a whole trial, nothing hidden or withheld."""
    shown = markers_as_scaled(capture.markers, subject)
    fixed = settings.correct_markers
    subject = correct_markers(subject, shown) if fixed else subject.in_neutral_posture()
    return trial_inputs(shown, capture.plates, subject, settings, body_errors=False)
