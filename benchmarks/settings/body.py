"""Combinations of the thesis's settings on the whole body: the first frames of a synthetic squat, frame by frame.

Each combination is asked for as a person does: a preset that comes with mbkf, and single settings over it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from benchmarks.settings.design import (
    BASE,
    FACTORS,
    Choices,
    every_combination,
    every_pair,
    single_changes,
)
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking import Track, track
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.filters import FilterInputs, tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.presets import with_preset, with_set
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise

MOST, UNIT = 0.01, "m"
"""Largest RMS distance of markers from the body: twice the noise that the filters count on."""

FRAMES, QUICK_FRAMES, SECONDS, LEAST_TRACKED = 10, 8, 1.0, 0.8
PRESETS = {"stable": "FDMC", "density": "FDMC-literal", "per frame": "FDMC-literal-per-frame"}
"""Preset of each kind of noise."""


class Squat(NamedTuple):
    """Inputs of the filters and the recording of the first frames."""

    inputs: FilterInputs
    recording: Recording


@cache
def squat(frames: int) -> Squat:
    """The first frames of a synthetic squat (seed 0, 3 mm skin, 0.5 mm cameras)."""
    subject, made = synthesise("squat", seconds=SECONDS)
    shown = subject_markers(made.trial.markers, subject)
    inputs, recording = trial_inputs(shown, made.trial.plates, subject, ReconstructSettings())
    return Squat(
        inputs, replace(recording, markers_m=recording.markers_m[:frames], plates=recording.plates[:frames])
    )


def runs(quick: bool) -> Mapping[Choices, float]:
    """RMS distance of markers from the body, m, of combinations; infinite where frames are lost or torques missing."""
    some = every_pair() if quick else every_combination()
    return {one: _error(followed(one, QUICK_FRAMES if quick else FRAMES)) for one in some}


def acting() -> list[bool]:
    """For each single change of the base: it changes the result."""
    base = followed(BASE, QUICK_FRAMES).q
    return [
        not np.allclose(followed(one, QUICK_FRAMES).q, base, rtol=1e-12, atol=1e-12)
        for one in single_changes()
    ]


def chosen(choices: Choices) -> ReconstructSettings:
    """Settings of a combination, from its preset and single settings."""
    words = dict(zip(FACTORS, choices, strict=True))
    preset = PRESETS[words.pop("noise")]
    start = with_preset(ReconstructSettings(smooth=False), preset)
    return with_set(start, [f"{name}={word}" for name, word in words.items()])


def followed(choices: Choices, frames: int) -> Track:
    """The track of a combination."""
    settings, (inputs, recording) = chosen(choices), squat(frames)
    with single_threaded():
        return track(
            tracking_filter("torque", replace(inputs, torque=settings.torque)), recording, spreads=()
        )


def _error(found: Track) -> float:
    """RMS distance of markers, m."""
    inputs, recording = squat(len(found.q))
    if found.tracked.mean() < LEAST_TRACKED or not np.isfinite(found.wrench[found.tracked]).all():
        return np.inf
    distances = [
        np.linalg.norm(inputs.sensor.positions(q) - seen, axis=1)
        for q, seen in zip(found.q, recording.markers_m, strict=True)
    ]
    return float(np.sqrt(np.nanmean(np.square(distances))))
