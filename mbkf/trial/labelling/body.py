"""A subject's markers on the body, with the search and the labeller that find them among unlabelled points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.labelling.assignment import Indices
from mbkf.labelling.first_frame import FirstFrameSearch
from mbkf.labelling.running import RunningLabeller, RunningSettings
from mbkf.model.human import HumanModel
from mbkf.scaling.correction import correct_markers
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.subject_sensor import subject_sensor
from mbkf.trial.labelling.any_attitude import AnyAttitude
from mbkf.trial.labelling.single_pass import LabellingPass

CORRECTED_SD_M = 0.006
"""Spread of a marker about its place as a first pass over the capture found it."""


@dataclass(frozen=True)
class LabelBody:
    """A subject's markers, with the search that finds them.

    Attributes:
        subject: The person.
        markers: The markers that may be worn.
        sensor: These markers on the person's body.
        search: Finds labels in frames without a prediction.
        settings: Settings of the labeller.
    """

    subject: Subject
    markers: tuple[SubjectMarker, ...]
    sensor: MarkerSensor
    search: FirstFrameSearch
    settings: RunningSettings

    @property
    def noise_m(self) -> Array:
        """(M,) marker noise."""
        return np.array([m.noise_m for m in self.markers])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the M markers."""
        return tuple(m.name for m in self.markers)

    def tracking_filter(self, dt_s: float) -> TrackingFilter:
        """A kinematic filter of the body."""
        unobservable = ~self.sensor.model.supports[self.sensor.joint_ids].any(axis=0)
        kalman = KinematicFilter(self.sensor, self.noise_m, dt_s, unobservable, KinematicSettings())
        return TrackingFilter(KinematicReport(kalman), WarmStart(kalman))

    def labeller(self, dt_s: float) -> RunningLabeller:
        """A labeller without memory."""
        placement = np.array([m.session_sd_m for m in self.markers])
        return RunningLabeller(self.noise_m, placement, dt_s, self.settings)

    def start_pass(self, positions_m: Array, dt_s: float, known: Indices | None = None) -> LabellingPass:
        """A pass over points with a filter and a labeller of its own.

        Args:
            positions_m: (T, C, 3) points, NaN where a column is empty.
            dt_s: Time between frames.
            known: (T, C) marker of the points that carry a reliable name; None where none does.
        """
        any_attitude = AnyAttitude(self.search, positions_m, 1.0 / dt_s)
        return LabellingPass(
            self.tracking_filter(dt_s), self.sensor, any_attitude, self.labeller(dt_s), positions_m, known
        )


def label_body(markers: Sequence[SubjectMarker], subject: Subject, settings: RunningSettings) -> LabelBody:
    """The body with the markers that scaling saw, or with all where the subject does not list these.

    Args:
        markers: Markers to search for.
        subject: The scaled person.
        settings: Settings of the labeller.
    """
    seen = subject.scaled_markers
    worn = tuple(m for m in markers if seen is None or m.name in seen)
    model = HumanModel.of(subject)
    sensor = subject_sensor(model, worn)
    sd = np.array([np.hypot(m.noise_m, m.session_sd_m) for m in worn])
    return LabelBody(subject, worn, sensor, FirstFrameSearch(sensor, sd), settings)


def corrected_body(body: LabelBody, found: MarkerTrajectories) -> LabelBody | None:
    """The body with the markers shown, corrected to their places, or None where these fit no body."""
    try:
        subject = correct_markers(body.subject, found)
    except MbkfError:
        return None
    worn = {
        name for name, seen in zip(found.names, np.asarray(found.present.any(axis=0)), strict=True) if seen
    }
    markers = [
        replace(m, session_sd_m=min(m.session_sd_m, CORRECTED_SD_M))
        for m in subject.markers
        if m.name in worn
    ]
    return label_body(markers, subject, RunningSettings(unseen_sd_m=0.0))
