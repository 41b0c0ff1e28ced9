"""Joint angles of pelvis and legs from sensors on them: orientations, a standing calibration, one segment model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput
from mbkf.imu.frames import attitude, conjugate, matrix_quaternion, multiply
from mbkf.imu.heading import HeadingSettings, held_headings, turned
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.placement import EIGHT, typical_mounts, usual_place
from mbkf.imu.segment_course import configurations
from mbkf.imu.segments import segment_of
from mbkf.imu.sensor_to_segment import (
    alignments,
    facing,
    mean_orientation,
)
from mbkf.imu.worn_mounts import worn_mounts
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings, between
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.clinical_table import opensim_zeros_rad
from mbkf.model.human import HumanModel
from mbkf.numerics.printed import percent
from mbkf.numerics.threads import single_threaded
from mbkf.trial.inertial.disturbed_magnetometers import (
    at_times,
    disturbed_magnetometers,
    free_orientations,
    turning_rates,
)
from mbkf.trial.inertial.orient import prepared
from mbkf.trial.inertial.standing import root_first, standing_window

_DOUBT_RAD, _DOUBT_SHARE, _DOUBT_EVERY = np.radians(15.0), 0.02, 5


@dataclass(frozen=True)
class AnglesSettings:
    """Settings of joint angles from inertial sensors.

    Attributes:
        orient: Filter of the orientations; sensors lie still while standing, so that their bias is read there.
        from_file: Whether the file's own orientations are used instead (they share one heading).
        hold_headings: Whether joints hold the headings.
        heading: Settings of the headings held by joints.
    """

    orient: OrientSettings = field(default_factory=lambda: OrientSettings("smooth"))
    from_file: bool = False
    hold_headings: bool = True
    heading: HeadingSettings = field(default_factory=HeadingSettings)


@dataclass(frozen=True)
class ImuAngles:
    """Angles over a recording.

    Attributes:
        time_s: (T,) s.
        q: (T, nq) configurations, at the origin, facing x where the person stood; joints without sensors are neutral.
        names: (A,) clinical coordinates that sensors determine.
        angles: (T, A) rad.
        opensim_zeros_rad: (A,) values of OpenSim's coordinates where these are 0.
        mounts: Rotation and place of every sensor on its segment.
        warnings: Remarks about the readings and the calibration.
    """

    time_s: Array
    q: Array
    names: tuple[str, ...]
    angles: Array
    opensim_zeros_rad: Array
    mounts: tuple[ImuMount, ...]
    warnings: tuple[str, ...]


def imu_angles(
    readings: Sequence[ImuReadings],
    model: HumanModel | None = None,
    *,
    standing: tuple[float, float] | Sequence[ImuReadings] | None = None,
    posture: Array | None = None,
    settings: AnglesSettings | None = None,
    progress: StageCallback | None = None,
) -> ImuAngles:
    """Angles of hips, knees, ankles and trunk.

    Args:
        readings: Sensors named after their segments; a pelvis sensor is needed.
        model: The body; None: the reference body.
        standing: Times of standing still in the recording, s, or a recording of it with the same magnetometers; by
            default the first second in which no sensor turns.
        posture: (nq,) the posture while standing; None: the neutral one.
        settings: Orientation filter and headings.
        progress: Called as samples are done.

    Raises:
        InvalidInput: Readings are not plausible, the pelvis sensor is missing, or the person never stands still.
        UnknownName: A sensor's segment is not known.
    """
    chosen, body = settings or AnglesSettings(), model or HumanModel.scaled()
    sensors, warnings = tuple(readings), tuple[str, ...]()
    if not chosen.from_file:
        sensors, warnings = prepared(readings)
    names = [segment_of(one.name, body.joints) for one in sensors]
    order = root_first(names, body.roles.root)
    sensors, segments = tuple(sensors[k] for k in order), [names[k] for k in order]
    clinical = ClinicalAngles(body)
    with single_threaded():
        still = None
        if isinstance(standing, Sequence) and standing and isinstance(standing[0], ImuReadings):
            still = _standing_sensors(standing, [one.name for one in sensors])
            sensors = tuple(_unbiased(one, rest) for one, rest in zip(sensors, still, strict=True))
        time_s = sensors[0].time_s
        q, common = _orientations(sensors, chosen, time_s, progress)
        window = None if still is not None else standing_window(sensors, time_s, standing)
        upright = mean_orientation(q[window]) if window is not None else _attitudes(still or ())
        disturbed = (
            disturbed_magnetometers(body, segments, sensors, q, upright)
            if common and not chosen.from_file
            else ()
        )
        left_out = [k for k, one in enumerate(sensors) if one.name in {bad.sensor for bad in disturbed}]
        rest = _posture(body, posture, segments)
        headings = _headings(body, segments, q, time_s, upright, rest, common, left_out)
        q, upright = turned(q, -headings[None]), turned(upright[None], -headings[None])[0]
        aligned = alignments(upright, rest, 0.0)
        if left_out:
            stood = still or _while_standing(sensors, time_s, window)
            q[:, left_out] = free_orientations([sensors[k] for k in left_out], time_s)
            aligned[left_out] = _by_standing_and_swinging(body, segments, sensors, stood, posture)[left_out]
        course = multiply(q, conjugate(aligned))
        if (chosen.hold_headings or left_out) and len(segments) > 1:
            dt = 1.0 / sensors[0].rate_hz
            held = held_headings(segments, course, dt, clinical.joints, chosen.heading, left_out)
            if not chosen.hold_headings:
                held[:, [k for k in range(len(segments)) if k not in left_out]] = 0.0
            course = turned(course, held)
        motion = configurations(body, segments, course)
    values = clinical.angles(motion)
    wanted = [k for k, name in enumerate(clinical.names) if _determined(clinical, name, segments)]
    mounts = tuple(
        ImuMount(one.name, segment, usual_place(body, segment), turn)
        for one, segment, turn in zip(sensors, segments, aligned, strict=True)
    )
    found = tuple(clinical.names[k] for k in wanted)
    remarks = (*warnings, *(one.remark for one in disturbed), *_doubts(body, segments, motion, common))
    by_name = opensim_zeros_rad(body.description.clinical_joints)
    zeros = np.array([by_name.get(name, 0.0) for name in found])
    return ImuAngles(time_s, motion, found, values[:, wanted], zeros, mounts, remarks)


def _standing_sensors(standing: Sequence[object], names: Sequence[str]) -> list[ImuReadings]:
    by_name = {one.name: one for one in standing if isinstance(one, ImuReadings)}
    missing = [name for name in names if name not in by_name or by_name[name].magnetic_field is None]
    if missing:
        raise InvalidInput(
            f"the standing recording lacks sensor {missing[0]} or its magnetometer; stand still in the trial itself"
        )
    return [by_name[name] for name in names]


def _while_standing(sensors: Sequence[ImuReadings], time_s: Array, window: slice | None) -> list[ImuReadings]:
    assert window is not None
    first, last = time_s[window.start], time_s[window.stop - 1]
    return [between(one, first, last) for one in sensors]


def _by_standing_and_swinging(
    body: HumanModel,
    segments: Sequence[str],
    sensors: Sequence[ImuReadings],
    stood: Sequence[ImuReadings],
    posture: Array | None,
) -> Array:
    """(S, 4) sensor → segment by gravity while standing and by how legs swing: no magnetometer is needed."""
    at_rest = _posture_of(body, posture)
    worn = worn_mounts(body, segments, stood, sensors, at_rest, posture is not None)
    return np.array([mount.rotation for mount in worn.mounts])


def _unbiased(one: ImuReadings, rest: ImuReadings) -> ImuReadings:
    bias = np.nanmean(rest.angular_velocity_rad_s, axis=0)
    return replace(one, angular_velocity_rad_s=one.angular_velocity_rad_s - bias)


def _attitudes(standing: Sequence[ImuReadings]) -> Array:
    found = []
    for one in standing:
        assert one.magnetic_field is not None
        found.append(
            attitude(np.nanmean(one.specific_force_mps2, axis=0), np.nanmean(one.magnetic_field, axis=0))
        )
    return np.array(found)


def _orientations(
    sensors: Sequence[ImuReadings], settings: AnglesSettings, time_s: Array, progress: StageCallback | None
) -> tuple[Array, bool]:
    """(T, S, 4) sensor → world at common times, and whether all have one heading."""
    if settings.from_file:
        if any(one.orientation is None for one in sensors):
            raise InvalidInput("the file brings no orientations; leave --from-file out")
        courses = [one.orientation for one in sensors]
        common = not any("arbitrary" in one.frame for one in sensors)
    else:
        found = orientations(sensors, frame="NWU", settings=settings.orient, progress=progress)
        courses = [one.quaternion for one in found]
        common = settings.orient.magnetometer and all(one.magnetic_field is not None for one in sensors)
    return np.stack(
        [at_times(one.time_s, course, time_s) for one, course in zip(sensors, courses, strict=True)], axis=1
    ), common


def _posture_of(body: HumanModel, posture: Array | None) -> Array:
    """(nq,) the posture while standing."""
    return body.neutral() if posture is None else posture


def _posture(body: HumanModel, posture: Array | None, segments: Sequence[str]) -> Array:
    """(S, 4) segment → world while standing, the pelvis facing x."""
    q = _posture_of(body, posture)
    rotations, _ = body.placements(q)
    turns = matrix_quaternion(np.array([rotations[body.joint(name).joint_id] for name in segments]))
    forward = rotations[body.root.joint_id][:, 0]
    heading = float(np.arctan2(forward[1], forward[0]))
    return turned(turns[None], np.full((1, len(segments)), -heading))[0]


def _headings(
    body: HumanModel,
    segments: Sequence[str],
    q: Array,
    time_s: Array,
    upright: Array,
    rest: Array,
    common: bool,
    left_out: Sequence[int],
) -> Array:
    """(S,) where each sensor's world sees the person face: one heading where they share it, else one each."""
    usual = _by_custom(body, segments, upright, rest)
    if not common:
        return usual
    # The turn of the person since standing is that of the first sensor whose field is sound, usually the pelvis's.
    sound = [k for k in range(len(segments)) if k not in left_out]
    gyro = turning_rates(q, time_s)[:, sound]
    seen = facing([segments[k] for k in sound], q[:, sound], gyro, upright[sound], body.roles.knees)
    if seen is None:
        seen = float(np.arctan2(np.sin(usual[sound]).mean(), np.cos(usual[sound]).mean()))
    return np.full(len(segments), seen)


def _by_custom(body: HumanModel, segments: Sequence[str], upright: Array, rest: Array) -> Array:
    """(S,) headings if every sensor were strapped on as people usually do."""
    worn = [name for name in segments if name in EIGHT]
    mounts = {mount.segment: mount.rotation for mount in typical_mounts(body, tuple(worn))}
    found = np.zeros(len(segments))
    for k, name in enumerate(segments):
        if name in mounts:
            off = multiply(upright[k], conjugate(multiply(rest[k], mounts[name])))
            found[k] = 2.0 * np.arctan2(off[2], off[3])
    return found


def _doubts(body: HumanModel, segments: Sequence[str], motion: Array, common: bool) -> list[str]:
    """Reasons to doubt the calibration: headings from the usual mounting only, joints beyond their anatomical range."""
    remarks = []
    if not common:
        remarks.append(
            "the sensors share no heading (no magnetometers): each is taken to be strapped on as usual, "
            "z away from the body and x up the limb; angles are wrong where one is not"
        )
    turns = np.array([body.difference(body.neutral(), q) for q in motion[::_DOUBT_EVERY]])
    beyond = np.maximum(turns - body.limits[:, 1], body.limits[:, 0] - turns)
    for name in segments[1:]:
        flexion = min(body.joint(name).v.start + 1, body.joint(name).v.stop - 1)
        share = float((beyond[:, flexion] > _DOUBT_RAD).mean())
        if share > _DOUBT_SHARE:
            remarks.append(
                f"the joint above {name} bends more than 15 deg beyond its range in {percent(share)} of the time; "
                "check --standing, which sensor is which, and how they were put on"
            )
    return remarks


def _determined(clinical: ClinicalAngles, name: str, segments: Sequence[str]) -> bool:
    """True where sensors on both sides of a joint determine its angle."""
    for joint in clinical.joints:
        if name in {angle.name for angle in joint.angles}:
            proximal = joint.proximal == "world" or joint.proximal in segments
            return joint.distal in segments and proximal
    return False
