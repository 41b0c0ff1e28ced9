"""The body's motion, contacts and torques from inertial sensors alone: no cameras, plates or magnetometers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.mount_errors import MountErrors
from mbkf.filters.record import Track
from mbkf.filters.tracking import track
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.imu.frames import conjugate, multiply, rotate
from mbkf.imu.heading import HeadingSettings, held_headings, turned
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.segment_course import configurations
from mbkf.imu.segments import segment_of
from mbkf.imu.turning import has_gyroscope, with_turning
from mbkf.imu.worn_mounts import MountSettings, SensorMounts, worn_mounts
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings, between
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.threads import single_threaded
from mbkf.trial.inertial.fields import DisturbedField, disturbed_fields
from mbkf.trial.inertial.misfit import Misfit, misfit
from mbkf.trial.inertial.motion_inputs import (
    MotionSettings,
    carrier,
    frame_times,
    motion_inputs,
    motion_recording,
    worn_filter,
)
from mbkf.trial.inertial.motion_result import Timeline, motion_result
from mbkf.trial.inertial.motion_start import StartSettings, first_posture
from mbkf.trial.inertial.mounted_reversed import SensorPlacement, mounted_reversed
from mbkf.trial.inertial.orient import prepared
from mbkf.trial.inertial.standing import carrier_first, standing_window

GUESS_S = 20.0
"""A start in motion is guessed from orientations over so long."""

FIELDS_EVERY = 5
"""Every so many frames magnetic fields are compared."""

ANY_HEADING = HeadingSettings(start_sd_rad=3.0)
"""Without magnetometers each sensor's heading is arbitrary."""


@dataclass(frozen=True)
class InertialMotionSettings:
    """Settings of a motion from inertial sensors alone.

    Attributes:
        filter: Noise of the sensors, how still feet stand, how exactly Newton's law holds.
        mounts: How well mounts are known from standing and swinging.
        start: How well the first posture is known.
        orient: Filter of the orientations that a start in motion is guessed from; magnetometers are left out.
        smooth: Whether later frames correct earlier ones.
        smoothing: How far they do. Between two steps nothing stands still: it looks further than with markers.
    """

    filter: MotionSettings = field(default_factory=MotionSettings)
    mounts: MountSettings = field(default_factory=MountSettings)
    start: StartSettings = field(default_factory=StartSettings)
    orient: OrientSettings = field(default_factory=lambda: OrientSettings("smooth", magnetometer=False))
    smooth: bool = True
    smoothing: SmoothingSettings = field(default_factory=lambda: SmoothingSettings(2.0, 1.0))


@dataclass(frozen=True)
class InertialMotion:
    """Result of inertial sensors on a body.

    Attributes:
        result: Motion, torques and reactions, with their standard deviations.
        mounts: How each sensor sits on its segment, as calibrated.
        gyro_bias_rad_s: (S, 3) gyroscopes' readings at rest.
        sensors: Names of the sensors.
        worn: Sensors that are worn otherwise than named or usual.
        disturbed_fields: Magnetometers whose field differs from the others'.
    """

    result: Reconstruction
    mounts: tuple[ImuMount, ...]
    gyro_bias_rad_s: Array
    sensors: tuple[str, ...]
    worn: SensorPlacement
    disturbed_fields: tuple[DisturbedField, ...]


@dataclass(frozen=True)
class _Plan:
    """Sensors in order, with their segments, their readings at rest, and the frames.

    Attributes:
        model: The body.
        sensors, segments: The sensors, that of :func:`carrier` first, and the segments that carry them.
        still: Their readings while the person stands.
        posture, posture_known: (nq,) posture then, and whether it was measured.
        from_standing: Whether the frames begin there.
        times_s: (T,) the frames.
        settings: Of the whole.
        derived: Segments of sensors without a gyroscope, whose angular velocities follow from orientations.
        turned: Segments whose sensors are strapped on the other way round than usual.
        early: (T, S, 4) orientations of the sensors, sensor → world (NWU), at their samples of a start in motion; None
            where the frames begin with standing.
    """

    model: HumanModel
    sensors: tuple[ImuReadings, ...]
    segments: tuple[str, ...]
    still: tuple[ImuReadings, ...]
    posture: Array
    posture_known: bool
    from_standing: bool
    times_s: Array
    settings: InertialMotionSettings
    derived: frozenset[str] = frozenset()
    turned: frozenset[str] = frozenset()
    early: Array | None = None


def inertial_motion(
    readings: Sequence[ImuReadings],
    subject: Subject,
    *,
    standing: tuple[float, float] | Sequence[ImuReadings] | None = None,
    posture: Array | None = None,
    trial: str = "motion",
    settings: InertialMotionSettings | None = None,
    progress: StageCallback | None = None,
) -> InertialMotion:
    """Motion, reactions and torques of a body from inertial sensors alone.

    The heading in which the person stands, or begins, is the laboratory's x axis.

    Args:
        readings: Sensors named after their segments: on the whole body, on one leg, on any of them. Without one on
            the pelvis it moves with the segment nearest to it, and the joint between them stays unknown. Reactions and
            torques need sensors on both feet. Magnetometers are not used.
        subject: The scaled person.
        standing: Times of standing still in the recording, s, or a recording of it; by default the first second in
            which no sensor turns. The motion begins there, unless it is a recording of its own.
        posture: (nq,) the posture while standing; None: the neutral one.
        trial: Name of the result.
        settings: Noise and priors.
        progress: Called with the stage, frames done and frames in all.

    Raises:
        InvalidInput: Readings are not plausible, a segment has two sensors, or the person never stands still.
        UnknownName: A sensor's segment is not known.
        NotObservable: The readings lead to an implausible motion.
    """
    chosen, model = settings or InertialMotionSettings(), HumanModel.of(subject)
    report = progress or (lambda *_: None)
    sensors, warnings = prepared([with_turning(one) for one in readings])
    names = [segment_of(one.name, model.joints) for one in sensors]
    order = carrier_first(names, carrier(model, names))
    sensors, segments = tuple(sensors[k] for k in order), tuple(names[k] for k in order)
    with single_threaded():
        plan = replace(
            _planned(model, sensors, segments, standing, posture, chosen),
            derived=frozenset(
                name for name, k in zip(segments, order, strict=True) if not has_gyroscope(readings[k])
            ),
        )
        if not plan.from_standing:
            plan = replace(plan, early=_early(plan))
        plan, worn, found, tracked = _tracked(plan, partial(report, "Filtering"))
        notes = (*warnings, *worn.remarks, *found.remarks)
        disturbed = disturbed_fields(*_magnetometers(plan, worn, tracked))
        result = motion_result(
            subject,
            segments,
            Timeline(trial, 1.0 / _dt(plan), float(plan.times_s[0])),
            tracked,
            notes=(*notes, *(one.remark for one in disturbed)),
            more={"inertial": asdict(chosen)},
            smooth=chosen.smooth,
        )
    return InertialMotion(
        result, worn.mounts, worn.bias_rad_s, tuple(one.name for one in sensors), found, disturbed
    )


def _tracked(
    plan: _Plan, progress: Callable[[int, int], None]
) -> tuple[_Plan, SensorMounts, SensorPlacement, Track]:
    """The motion, and the mounting it was found with: the usual one unless another explains the readings better.

    Other mountings are looked at as soon as the run with the usual one has gone through the frames that count.

    Args:
        plan: Sensors as named.
        progress: Called with frames done and frames in all.
    """
    worn = _worn(plan)
    filter, recording = _filter(plan, worn)
    named, found = Misfit(filter, recording), list[SensorPlacement]()

    def judge(turned: frozenset[str], names: Mapping[str, str], beyond: float) -> float:
        filter, recording = _filter(_renamed(plan, turned, names))
        filter.kalman.follows_spreads = False  # no estimate depends on them
        return misfit(filter, recording, beyond)

    def settled() -> SensorPlacement:
        if not found:
            found.append(mounted_reversed(plan.model, plan.segments, named.value, judge))
        return found[0]

    def goes_on(t: int, posterior: Posterior) -> bool:
        named.add(t, posterior)
        return t < named.frames - 1 or not settled().turned

    def run(filter: TrackingFilter, filtered: Callable[[int, Posterior], bool] | None = None) -> Track:
        return track(
            filter,
            recording,
            smoothing=plan.settings.smoothing if plan.settings.smooth else None,
            body=MountErrors(plan.model, plan.segments, worn.turn_sd_rad),
            progress=progress,
            filtered=filtered,
        )

    tracked, placement = run(filter, goes_on), settled()
    if placement.turned:
        plan = replace(plan, turned=placement.turned)
        worn = _worn(plan)
        tracked = run(_filter(plan, worn)[0])
    return plan, worn, placement, tracked


def _renamed(plan: _Plan, turned: frozenset[str], names: Mapping[str, str]) -> _Plan:
    """The plan with sensors strapped on otherwise, or on other segments.

    Args:
        plan: Sensors as named.
        turned: Segments whose sensors are the other way round.
        names: Other segment by segment.
    """
    segments = tuple(names.get(name, name) for name in plan.segments)
    derived = frozenset(names.get(name, name) for name in plan.derived)
    return replace(plan, turned=turned, segments=segments, derived=derived)


def _worn(plan: _Plan) -> SensorMounts:
    """Mounts of the sensors."""
    known = plan.model, plan.segments, plan.still, plan.sensors, plan.posture, plan.posture_known
    return worn_mounts(*known, plan.settings.mounts, plan.turned, plan.derived)


def _filter(plan: _Plan, worn: SensorMounts | None = None) -> tuple[TrackingFilter, Recording]:
    """The filter and its readings.

    Args:
        plan: Sensors and frames.
        worn: Mounts of the sensors; None: to be found.
    """
    sensors, s = worn or _worn(plan), plan.settings
    inputs = motion_inputs(plan.model, _dt(plan), plan.segments)
    standing_q = plan.posture if plan.posture_known else None
    filter = worn_filter(inputs, sensors, _first(plan, sensors), s.filter, standing_q)
    known = plan.sensors, plan.segments, plan.model, plan.times_s, s.filter
    return filter, motion_recording(*known, causal=not s.smooth)


def _magnetometers(plan: _Plan, worn: SensorMounts, tracked: Track) -> tuple[list[ImuReadings], list[Array]]:
    """Sensors with their fields at the frames, and how each is turned then.

    Args:
        plan: Sensors and frames.
        worn: How the sensors sit.
        tracked: The motion.
    """
    thinned = slice(None, None, FIELDS_EVERY)
    times, rotations = (
        plan.times_s[thinned],
        np.array([plan.model.placements(q)[0] for q in tracked.q[thinned]]),
    )
    readings, turns = [], []
    for one, mount in zip(plan.sensors, worn.mounts, strict=True):
        if one.magnetic_field is None:
            continue
        field = np.column_stack(
            [np.interp(times, one.time_s, axis) for axis in np.transpose(one.magnetic_field)]
        )
        force, rate = np.zeros((2, len(times), 3))
        readings.append(ImuReadings(one.name, times, force, rate, field, one.rate_hz))
        joint = plan.model.joint(mount.segment).joint_id
        turns.append(rotations[:, joint] @ quaternion_matrices(mount.rotation))
    return readings, turns


def _planned(
    model: HumanModel,
    sensors: tuple[ImuReadings, ...],
    segments: tuple[str, ...],
    standing: tuple[float, float] | Sequence[ImuReadings] | None,
    posture: Array | None,
    settings: InertialMotionSettings,
) -> _Plan:
    """Where the person stands, and the frames from there on.

    Args:
        model: The body.
        sensors: The sensors.
        segments: Segments that carry them.
        standing: As for :func:`inertial_motion`.
        posture: (nq,); None: neutral.
        settings: Of the whole.
    """
    at_rest, known = (model.neutral(), False) if posture is None else (posture, True)
    times = frame_times(sensors[0])
    if isinstance(standing, Sequence) and standing and isinstance(standing[0], ImuReadings):
        by_name = {one.name: one for one in standing if isinstance(one, ImuReadings)}
        missing = [one.name for one in sensors if one.name not in by_name]
        if missing:
            raise InvalidInput(f"the standing recording lacks sensor {missing[0]}")
        still = tuple(by_name[one.name] for one in sensors)
        return _Plan(model, sensors, segments, still, at_rest, known, False, times, settings)
    window = standing_window(sensors, sensors[0].time_s, standing)
    first, last = (float(sensors[0].time_s[k]) for k in (window.start, window.stop - 1))
    still = tuple(between(one, first, last) for one in sensors)
    return _Plan(model, sensors, segments, still, at_rest, known, True, times[times >= first], settings)


def _dt(plan: _Plan) -> float:
    return float(plan.times_s[1] - plan.times_s[0])


def _early(plan: _Plan) -> Array:
    """(T, S, 4) orientations of the sensors over the first samples of a motion, sensor → world (NWU)."""
    begin = float(plan.times_s[0])
    early = [
        replace(part, angular_velocity_rad_s=part.angular_velocity_rad_s - bias)
        for part, bias in (
            (between(one, begin, begin + GUESS_S), bias)
            for one, bias in zip(plan.sensors, _worn(plan).bias_rad_s, strict=True)
        )
    ]
    found = orientations(early, frame="NWU", settings=plan.settings.orient)
    return np.stack([one.quaternion for one in found], axis=1)


def _first(plan: _Plan, worn: SensorMounts) -> KinematicState:
    """The first posture: that of standing, or by the sensors' orientations at a start in motion."""
    dt, start = _dt(plan), plan.settings.start
    if plan.early is None:
        return first_posture(plan.model, plan.segments, np.tile(plan.posture, (2, 1)), dt, True, start)
    begin, carrying = float(plan.times_s[0]), plan.sensors[0]
    times = between(carrying, begin, begin + GUESS_S).time_s
    steps = [int(np.searchsorted(times, begin + k * dt - 1e-9)) for k in (0, 1)]
    course = multiply(plan.early, conjugate(np.array([mount.rotation for mount in worn.mounts])))
    held = held_headings(
        plan.segments, course, 1.0 / carrying.rate_hz, ClinicalAngles(plan.model).joints, ANY_HEADING
    )
    side = rotate(course[0, 0], np.array([0.0, 1.0, 0.0]))
    forward = float(np.arctan2(-side[0], side[1]))
    course = turned(course, held - forward)
    guess = configurations(plan.model, plan.segments, course[steps])
    return first_posture(plan.model, plan.segments, guess, dt, False, start)
