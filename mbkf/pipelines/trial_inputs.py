"""What a filter is built from and reads, made of a capture and a subject as `reconstruct` does it."""

from __future__ import annotations

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.pipelines.followers import FilterInputs
from mbkf.pipelines.reconstruct import MIN_PRESENT, ReconstructSettings, subject_markers
from mbkf.scaling.correction import correct_markers
from mbkf.sensors.contacts import plate_wrenches
from mbkf.sensors.markers import MarkerSensor


def trial_inputs(
    capture: Capture, subject: Subject, settings: ReconstructSettings
) -> tuple[FilterInputs, Recording]:
    """Body, markers and plates of a trial, and its readings; nothing is hidden or withheld.

    Raises:
        NotObservable: Too few of the subject's markers.
        NotConverged: The markers do not fit the subject's body.
    """
    shown = subject_markers(capture.markers, subject)
    if settings.correct_markers:
        subject = correct_markers(subject, shown)
    model = HumanModel.scaled(subject.scale_factors, subject.mass_kg, subject.body)
    by_name = {marker.name: marker for marker in subject.markers}
    followed = [by_name[name] for name in shown.names]
    sensor = MarkerSensor(model, [m.segment for m in followed], np.array([m.position_m for m in followed]))
    present = shown.present.mean(axis=0) >= MIN_PRESENT
    inputs = FilterInputs(
        sensor,
        np.array([m.noise_m for m in followed]),
        capture.plates,
        1.0 / shown.rate_hz,
        ~model.supports[sensor.joint_ids[present]].any(axis=0),
        settings.kinematic,
        settings.dynamic,
        settings.torque,
    )
    wrenches = plate_wrenches(capture.plates, shown.times_s, shown.rate_hz)
    return inputs, Recording(shown.positions_m, wrenches, inputs.dt_s)
