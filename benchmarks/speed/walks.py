"""Walks to time, synthetic and real, with the filters and readings that `mbkf reconstruct` makes of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import SOURCES
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.person import body_of
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

REAL = "rajagopal walk"
APART_M = np.array([0.02, 0.0, 0.02])
NOISE_M = 0.003


@dataclass(frozen=True)
class Walk:
    """A person's walk.

    Attributes:
        subject: The scaled person.
        capture: Markers and plates.
    """

    subject: Subject
    capture: Capture

    def dynamic(self) -> tuple[TrackingFilter, Recording, BodyErrors | None]:
        """The dynamic filter, what it reads, and the errors of the person's body."""
        return self._filter("dynamic")

    def kinematic(self) -> tuple[TrackingFilter, Recording]:
        """The kinematic filter and what it reads."""
        found, recording, _ = self._filter("kinematic")
        return found, recording

    def _filter(self, name: str) -> tuple[TrackingFilter, Recording, BodyErrors | None]:
        settings = ReconstructSettings(filter=name)
        with single_threaded():
            measured = subject_markers(self.capture.markers, self.subject)
            inputs, recording = trial_inputs(measured, self.capture.plates, self.subject, settings)
            return tracking_filter(name, inputs), recording, inputs.body


def synthetic(seconds: float, markers: int | None = None) -> Walk:
    """A random person's walk over two plates.

    Args:
        seconds: Duration.
        markers: How many markers the person wears: those of the protocol again and again, each time a little further
            on; None for those of the protocol, as cameras saw them.
    """
    subject, made = synthesise("walk", seconds=seconds)
    if markers is None:
        return Walk(subject, made.trial)
    own, model = subject.markers, body_of(subject)
    worn = [
        replace(
            own[k % len(own)],
            name=f"marker {k}",
            position_m=own[k % len(own)].position_m + k // len(own) * APART_M,
        )
        for k in range(markers)
    ]
    sensor = MarkerSensor(model, [one.segment for one in worn], np.array([one.position_m for one in worn]))
    places = np.array([sensor.positions(q) for q in made.truth.q])
    places += NOISE_M * np.random.default_rng(0).normal(size=places.shape)
    seen = replace(made.trial.markers, names=tuple(one.name for one in worn), positions_m=places)
    return Walk(replace(subject, markers=tuple(worn)), replace(made.trial, markers=seen))


def real(data: Path) -> Walk:
    """The walk of the Rajagopal capture, its person scaled from the standing trial."""
    source = SOURCES[REAL]
    folder = data / source.folder
    assert source.static is not None
    subject = scale(read_capture(folder / source.static), mass_kg=source.mass_kg)
    forces = None if source.forces is None else folder / source.forces
    return Walk(subject, read_capture(folder / source.trial, forces=forces))


def with_plates(walk: Walk, plates: int) -> Walk:
    """The same walk with so many plates: further ones lie far away and read nothing.

    Args:
        walk: The walk, with at least one plate.
        plates: How many.
    """
    own = list(walk.capture.plates[:plates])
    far = [_elsewhere(own[0], k) for k in range(plates - len(own))]
    return replace(walk, capture=replace(walk.capture, plates=tuple(own + far)))


def _elsewhere(plate: PlateReadings, k: int) -> PlateReadings:
    """A plate ten metres further for each k, which nobody steps on."""
    off_m, nothing = np.array([0.0, 10.0 * (k + 1), 0.0]), np.zeros_like(plate.force_n)
    return replace(
        plate,
        name=f"far {k + 1}",
        origin_m=plate.origin_m + off_m,
        corners_m=None if plate.corners_m is None else plate.corners_m + off_m,
        force_n=nothing,
        moment_nm=nothing,
        centre_of_pressure_m=np.full_like(plate.centre_of_pressure_m, np.nan),
    )
