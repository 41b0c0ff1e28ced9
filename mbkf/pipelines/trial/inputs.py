"""A filter's inputs and readings, from a trial's markers and plates and its subject."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.io.records import MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.pipelines.trial.filters import FilterInputs
from mbkf.sensors.contact.cleaning import cleaned
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.marker_sensor import MarkerSensor

MIN_PRESENT = 0.02
"""A marker seen in a smaller share of the frames than this does not count for what can be observed."""


class FilterSettings(Protocol):
    """Settings of every filter."""

    @property
    def kinematic(self) -> KinematicSettings:
        """Settings of the kinematic filter."""

    @property
    def dynamic(self) -> DynamicSettings:
        """Settings of the dynamic filter."""

    @property
    def torque(self) -> TorqueSettings:
        """Settings of the torque filter."""


def trial_inputs(
    shown: MarkerTrajectories, plates: tuple[PlateReadings, ...], subject: Subject, settings: FilterSettings
) -> tuple[FilterInputs, Recording]:
    """Body, markers and plates of a trial, and its readings; the plates without what this person cannot make them read.

    Args:
        shown: (T, M, 3) m, under the subject's own names; what is hidden is NaN.
        plates: The plates that are read.
        subject: The person, with marker positions as they are to be used.
        settings: Settings of the filters.
    """
    model = HumanModel.of(subject)
    plates, remarks = cleaned(plates, subject.mass_kg)
    by_name = {marker.name: marker for marker in subject.markers}
    tracked = [by_name[name] for name in shown.names]
    sensor = MarkerSensor(model, [m.segment for m in tracked], np.array([m.position_m for m in tracked]))
    present = shown.present.mean(axis=0) >= MIN_PRESENT
    inputs = FilterInputs(
        sensor,
        np.array([m.noise_m for m in tracked]),
        plates,
        1.0 / shown.rate_hz,
        ~model.supports[sensor.joint_ids[present]].any(axis=0),
        settings.kinematic,
        settings.dynamic,
        settings.torque,
        remarks=remarks,
    )
    wrenches = plate_wrenches(plates, shown.times_s, shown.rate_hz)
    return inputs, Recording(shown.positions_m, wrenches, inputs.dt_s)
