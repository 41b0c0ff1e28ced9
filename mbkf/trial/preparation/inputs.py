"""A filter's inputs and readings, from a trial's markers and plates and its subject."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy.linalg import block_diag

from mbkf.conventions import Array, BoolArray
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.io.records import MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.human import HumanModel
from mbkf.model.subject_covariance import covariance_of
from mbkf.sensors.contact.cleaning import cleaned
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.flexed_skin import FlexedSkin, slide_covariance
from mbkf.sensors.holes import posture_scales
from mbkf.sensors.lasting_noise import MOVEMENT_HZ, white_noise_m
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.subject_sensor import subject_sensor
from mbkf.trial.preparation.filters import FilterInputs

NEVER_LEARNT = 0.3
"""Share of the skin's spread that no scaling removes: skin is not exactly of the form that is fitted."""

MIN_PRESENT = 0.02
"""A marker seen in a smaller share of the frames than this does not count as observing a dof."""


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
    shown: MarkerTrajectories,
    plates: tuple[PlateReadings, ...],
    subject: Subject,
    settings: FilterSettings,
    *,
    body_errors: bool = True,
) -> tuple[FilterInputs, Recording]:
    """Body, markers and plates of a trial, and its readings; the plates without readings that this person cannot cause.

    Args:
        shown: (T, M, 3) m, under the subject's own names; hidden samples are NaN.
        plates: The plates that are read.
        subject: The person, with marker positions as they are to be used.
        settings: Settings of the filters.
        body_errors: False leaves errors by the body out, which the spreads of an estimate need and its mean does not.
    """
    model = HumanModel.of(subject)
    plates, remarks = cleaned(plates, subject.mass_kg)
    by_name = {marker.name: marker for marker in subject.markers}
    tracked = [by_name[name] for name in shown.names]
    sensor = subject_sensor(model, tracked)
    noise_m, spread_m = _noise(tracked, 1.0 / shown.rate_hz, settings.dynamic.markers.innovation_share)
    present = shown.present.mean(axis=0) >= MIN_PRESENT
    unobservable = ~model.supports[sensor.joint_ids[present]].any(axis=0)
    inputs = FilterInputs(
        sensor,
        noise_m,
        plates,
        1.0 / shown.rate_hz,
        unobservable,
        settings.kinematic,
        settings.dynamic,
        settings.torque,
        spread_m=spread_m,
        remarks=remarks,
        names=shown.names,
        body=_body_errors(sensor, noise_m, shown.names, subject, unobservable) if body_errors else None,
    )
    wrenches = plate_wrenches(plates, shown.times_s, shown.rate_hz)
    return inputs, Recording(shown.positions_m, wrenches, inputs.dt_s)


def _body_errors(
    sensor: MarkerSensor, noise_m: Array, names: Sequence[str], subject: Subject, unobservable: BoolArray
) -> BodyErrors | None:
    """Errors by the unknowns of scaling, and by how the person holds joints.

    A marker that scaling did not see may be anywhere that its session allows. Of dofs that no marker shows the filter
    itself knows the spread of the posture.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) standard deviation that filters weigh each with.
        names: Their names.
        subject: The person.
        unobservable: (nv,) True for a dof that moves no marker.
    """
    known = covariance_of(subject, sensor.model.description)
    if known is None:
        return None
    session = {marker.name: marker.session_sd_m for marker in subject.markers}
    keypoint = {marker.name for marker in subject.markers if marker.correlated_m > 0.0}
    segments = ["" if name in keypoint else s for name, s in zip(names, sensor.segments, strict=True)]
    unseen = slide_covariance(sensor.model.description, segments)
    root = known.rows(names, session, unseen)
    never_learnt = [np.zeros((len(root) - len(unseen) * 3 * len(names), 0))]
    never_learnt += [NEVER_LEARNT * np.linalg.cholesky(one) for one in unseen]
    root = np.hstack([root, block_diag(*never_learnt)])
    skin = FlexedSkin(sensor.model, segments) if len(unseen) else None
    people_rad = sensor.model.posture_sd
    held_rad = np.where(unobservable, 0.0, people_rad)
    return BodyErrors(
        sensor, noise_m, root, skin, held_rad, posture_scales(sensor, unobservable) * people_rad
    )


def _noise(markers: Sequence[SubjectMarker], dt_s: float, share: float) -> tuple[Array, Array | None]:
    """(M,) white noise of equal weight, and (M,) spread of one reading where any marker's noise stays for a while.

    Args:
        markers: The M markers.
        dt_s: Time between frames.
        share: Share of an independent reading that a frame of a marker on skin counts for.
    """
    own = np.array([m.noise_m for m in markers])
    correlated = np.array([m.correlated_m for m in markers])
    if not correlated.any():
        return own, None
    lasting_s = np.array([m.correlation_s for m in markers])
    noise = white_noise_m(own, correlated, lasting_s, dt_s, MOVEMENT_HZ)
    return noise, np.where(correlated > 0.0, own, own * share**0.5)
