"""Captures for the checks, followed by their markers once, and judged with any mass and any plates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.checks import Context
from benchmarks.dynamic.captures import Person, load
from mbkf.io.findings import Finding
from mbkf.io.records import MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject
from mbkf.sensors.supports.block import BEARING
from mbkf.synthesis.capture import CaptureSettings
from mbkf.trial.checks.judge import plate_checks
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import Motion, markers_alone
from mbkf.trial.preparation.other_contacts import with_other_contacts
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise

KNOWN = ("rajagopal walk", "rajagopal run", "gait2354", "biomechzoo HC032A", "biomechzoo HC044A")
KNOWN_MOTIONS = (("squat", 0), ("belt_walk", 0))
"""Thresholds were set on these, captures and motions of persons."""

SHOWN = ("gaitalytics",)
SHOWN_MOTIONS = (("walk", 3), ("squat", 4), ("general", 2), ("split_belt_walk", 4))
"""Only looked at. In gaitalytics a foot lands beside the plates, which no check knows of."""

SETTINGS = ReconstructSettings()


@dataclass(frozen=True)
class Followed:
    """A capture with the motion of its markers alone."""

    name: str
    markers: MarkerTrajectories
    subject: Subject
    plates: tuple[PlateReadings, ...]
    motion: Motion

    def judged(
        self, mass_factor: float = 1.0, plates: Sequence[PlateReadings] | None = None
    ) -> tuple[Finding, ...]:
        """All checks of the plates, as `mbkf reconstruct` makes them.

        Args:
            mass_factor: The subject's mass is wrong by it.
            plates: Spoilt plates; None for those of the capture.
        """
        subject = replace(self.subject, mass_kg=mass_factor * self.subject.mass_kg)
        given = self.plates if plates is None else tuple(plates)
        inputs, recording = trial_inputs(self.markers, given, subject, SETTINGS)
        times = self.markers.times_s
        inputs, recording = with_other_contacts(inputs, recording, times, self.motion)
        others = recording.readings.get(BEARING)
        bears = None if others is None else np.asarray(np.asarray(others).any(axis=1))
        model = inputs.sensor.model
        return plate_checks(model, self.motion, times, self.markers.rate_hz, inputs.plates, bears)


def known_persons(context: Context) -> Iterator[Person]:
    """Those on which thresholds were set; with quick, two of them."""
    yield from (load(name, context.require_data()) for name in KNOWN[: 1 if context.quick else None])
    yield from (made(*one) for one in KNOWN_MOTIONS[: 1 if context.quick else None])


def shown_persons(context: Context) -> Iterator[Person]:
    """Those that were only looked at; none with quick."""
    if not context.quick:
        yield from (load(name, context.require_data()) for name in SHOWN)
        yield from (made(*one) for one in SHOWN_MOTIONS)


def made(motion: str, seed: int) -> Person:
    """A synthetic person, with plates without offsets, as readers of files give them."""
    subject, capture = synthesise(motion, seed=seed, settings=CaptureSettings(offset_n=(0.0, 0.0)))
    return Person(f"synthetic {motion}, person {seed}", capture.trial, subject)


def prepared(person: Person) -> Followed:
    """A person followed by the markers."""
    markers = subject_markers(person.capture.markers, person.subject)
    inputs, recording = trial_inputs(markers, person.capture.plates, person.subject, SETTINGS)
    motion = markers_alone(inputs, recording)
    return Followed(person.name, markers, person.subject, person.capture.plates, motion)
