"""The dynamic filter and its readings for a body that inertial sensors alone show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.posture_start import PostureStart
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.imu.rest_watch import FeetAtRest
from mbkf.imu.worn_mounts import SensorMounts
from mbkf.imu.zero_velocity import StillnessSettings, still_samples
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.body import Body
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import AnyBlock
from mbkf.sensors.body_sensors import BodySensors, BodySensorSettings
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.foot_contact import FootContact, FootContactSettings
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.load_transfer import LoadTransfer, LoadTransferSettings
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import Markers
from mbkf.sensors.newton_euler import NewtonEulerLaw, NewtonEulerSettings
from mbkf.sensors.posture import PosturePrior
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.standing_feet import FOOT_REST, StandingFeet, StandingSettings
from mbkf.sensors.unseen_moment import UnseenMoment, UnseenMomentSettings
from mbkf.sensors.worn_orientations import WornOrientations, WornOrientationSettings
from mbkf.trial.inertial.on_body import frame_readings
from mbkf.trial.preparation.filters import FilterInputs

MOST_HZ = 130.0
"""Sensors that are faster are averaged down to a whole part of their rate below this."""


DECAY_S = 0.04
"""Time in which an acceleration fades; its jerk is white within a frame."""


@dataclass(frozen=True)
class MotionSettings:
    """The filter on inertial sensors alone.

    Attributes:
        worn: Noise of the sensors.
        orientations: Noise of their orientations, where another system states them.
        standing: How still feet stand.
        stillness: When a foot's own sensor is at rest.
        transfer: How load passes from foot to foot in walking.
        unseen: Moment of arms and head, which no sensor shows.
        residual_force_n, residual_moment_nm: Spread of Newton's law: arms and head move unseen.
        posture_scale: Factor on the spread of the posture prior. Sensors show a posture's changes much better than the
            posture: the usual weight, in every frame, would draw the mounts along.
    """

    worn: BodySensorSettings = field(default_factory=BodySensorSettings)
    orientations: WornOrientationSettings = field(default_factory=WornOrientationSettings)
    standing: StandingSettings = field(default_factory=StandingSettings)
    stillness: StillnessSettings = field(default_factory=StillnessSettings)
    transfer: LoadTransferSettings = field(default_factory=LoadTransferSettings)
    unseen: UnseenMomentSettings = field(default_factory=UnseenMomentSettings)
    residual_force_n: float = 60.0
    residual_moment_nm: float = 200.0
    posture_scale: float = 30.0


def frame_times(one: ImuReadings) -> Array:
    """(T,) times of the frames: the sensor's own, thinned out where they are many."""
    return one.time_s[:: max(1, int(np.ceil(one.rate_hz / MOST_HZ)))]


def motion_inputs(model: HumanModel, dt_s: float, segments: Sequence[str]) -> FilterInputs:
    """A filter's inputs without markers and plates.

    Args:
        model: The body.
        dt_s: Time between frames.
        segments: Segments that carry sensors.
    """
    none = MarkerSensor(model, [], np.zeros((0, 3)))
    settings = KinematicSettings(), DynamicSettings(), TorqueSettings()
    return FilterInputs(none, np.zeros(0), (), dt_s, unobserved(model, segments), *settings)


def carrier(model: HumanModel, segments: Sequence[str]) -> str:
    """The segment whose sensor shows where the root is: the root's own, else the one nearest to it.

    Args:
        model: The body.
        segments: Segments that carry sensors.
    """
    parents = {one.name: one.parent for one in model.description.segments}

    def depth(name: str) -> int:
        return 0 if name == model.roles.root else 1 + depth(parents[name])

    return min(segments, key=depth)


def unobserved(model: HumanModel, segments: Sequence[str]) -> BoolArray:
    """(nv,) dofs that no sensor observes; they keep the neutral posture.

    A root without a sensor moves with the segment of :func:`carrier`: the joint between them is unobserved.
    """
    found = np.ones(model.nv, dtype=bool)
    first = carrier(model, segments)
    for name in (model.roles.root, *(name for name in segments if name != first)):
        found[model.joint(name).v] = False
    return found


def motion_recording(
    readings: Sequence[ImuReadings],
    segments: Sequence[str],
    model: HumanModel,
    times_s: Array,
    settings: MotionSettings,
    causal: bool = False,
) -> Recording:
    """Readings of the sensors at the frames' times, and times at which each foot is at rest.

    Args:
        readings: The sensors.
        segments: Segments that carry them.
        model: The body.
        times_s: (T,) the frames, s.
        settings: When a foot is at rest.
        causal: Rests are recognised by the readings until then, as live.
    """
    frames, dt_s = len(times_s), float(times_s[1] - times_s[0])
    imus = frame_readings(readings, times_s)
    if causal:
        feet = FeetAtRest(model.roles.feet, segments, 1.0 / dt_s, settings.stillness)
        rest = np.array([feet.push(one) for one in imus])
    else:
        rest = _rest(readings, segments, model, times_s, settings)
    none = np.zeros((frames, 0, 3)), np.zeros((frames, 0, 6))
    return Recording(*none, dt_s, imus, {FOOT_REST: rest})


def _rest(
    readings: Sequence[ImuReadings],
    segments: Sequence[str],
    model: HumanModel,
    times_s: Array,
    settings: MotionSettings,
) -> Array:
    """(T, 2) 1 where the right, the left foot rests, by the readings about that time.

    Args:
        readings: The sensors.
        segments: Segments that carry them.
        model: The body.
        times_s: (T,) the frames, s.
        settings: When a foot is at rest.
    """
    rest = np.zeros((len(times_s), 2))
    for foot, name in enumerate(model.roles.feet):
        if name not in segments:
            continue
        one = readings[segments.index(name)]
        force, rate = (np.nan_to_num(x) for x in (one.specific_force_mps2, one.angular_velocity_rad_s))
        still = still_samples(force, rate, one.rate_hz, settings.stillness)
        rest[:, foot] = np.interp(times_s, one.time_s, still.astype(float)) > 0.5
    return rest


def worn_filter(
    inputs: FilterInputs,
    worn: SensorMounts,
    first: KinematicState,
    settings: MotionSettings,
    standing_q: Array | None = None,
    oriented: bool = False,
) -> TrackingFilter:
    """The filter.

    Args:
        inputs: Of :func:`motion_inputs`.
        worn: The calibrated sensors.
        first: The first posture.
        settings: Noise.
        standing_q: (nq,) posture while standing where it was measured.
        oriented: Whether frames bring the sensors' orientations.
    """
    model, dt, unobservable = inputs.sensor.model, inputs.dt_s, inputs.unobservable
    s, posture = inputs.dynamic, PostureSensor(inputs.sensor.model)
    s = replace(s, motion=replace(s.motion, constant_jerk=False, decay_s=DECAY_S))
    law = replace(
        s.law, residual_force_n=settings.residual_force_n, residual_moment_nm=settings.residual_moment_nm
    )
    sensors, bias_sd = InertialSensor(model, worn.mounts), np.repeat(worn.bias_sd_rad_s[:, None], 3, axis=1)
    sensed = {mount.segment for mount in worn.mounts}
    # A foot without a sensor may be anywhere, and so may its load.
    ground = _ground(model, dt, law, s.contact, settings) if sensed >= set(model.roles.feet) else []
    blocks: list[AnyBlock] = [
        Markers(inputs.sensor, inputs.noise_m, dt, unobservable, s.markers),
        *ground,
        StandingFeet(model, dt, settings.standing, standing_q),
        BodySensors(sensors, worn.bias_rad_s, bias_sd, worn.turn_sd_rad, settings.worn),
        *([WornOrientations(sensors, settings.orientations)] if oriented else []),
        PosturePrior(posture, unobservable, replace(s.posture, posture_scale=settings.posture_scale)),
        JointLimits(posture, unobservable, s.limits),
    ]
    kalman = DynamicFilter(inputs.sensor, inputs.noise_m, dt, unobservable, s, blocks)
    start = PostureStart(first, unobservable, inputs.kinematic.restart_after_s)
    return TrackingFilter(DynamicReport(kalman), start)


def _ground(
    model: Body,
    dt_s: float,
    law: NewtonEulerSettings,
    contact: FootContactSettings,
    settings: MotionSettings,
) -> list[AnyBlock]:
    """Newton's law, the feet's contact, the transfer of load between them, and the moment of unseen segments.

    Args:
        model: The body.
        dt_s: Time between frames.
        law: How exactly the law holds.
        contact: Noise of the reactions.
        settings: Of the load transfer and of unseen segments.
    """
    by_pitch = replace(contact, free_push_share=np.inf)  # heights of soles leave it open
    return [
        NewtonEulerLaw(NewtonEuler(model), law),
        FootContact(ContactDetector(model, (), dt_s), GRAVITY_M_S2 * model.mass_kg, dt_s, by_pitch),
        LoadTransfer(model, dt_s, settings.transfer),
        UnseenMoment(dt_s, settings.unseen),
    ]
