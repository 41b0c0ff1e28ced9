"""The body's motion from sensors without magnetometers: synthetic and real motions, bad magnetometers, OpenSense.

Virtual sensors are put on 5° askew, with biases of 0.5°/s, and calibrated on a person who stands in a known posture.
OpenSense's walk brings the maker's orientations, with magnetometers, and no gyroscopes; its angles by inverse
kinematics are those of `mbkf imu angles --from-file`, which are compared with what the same sensors tell without
headings.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.dynamic.captures import SOURCES
from benchmarks.inertial.body import SAGITTAL
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.io.capture import read_capture
from mbkf.io.contacts import Source
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.scaling.stature import person_of_stature
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.inertial.angles import AnglesSettings, ImuAngles, imu_angles
from mbkf.trial.inertial.motion import InertialMotion, inertial_motion
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

RATE_HZ, STANDING_S, SETTLED_S = 100.0, 5.0, 1.0
ERRORS, ASKEW_RAD = ImuErrors(gyro_bias_sd_rad_s=float(np.radians(0.5))), float(np.radians(5.0))
REAL = ("rajagopal walk", "biomechzoo HC032A")
BAD = {
    "turned by 90 deg": lambda field: field[:, [1, 0, 2]] * [1.0, -1.0, 1.0],
    "0.3 of its size": lambda field: 0.3 * field,
}
OPENSENSE = 75.0, 1.75
"""Mass and height that OpenSense's walker is taken to have; the file states none, and angles do not depend on them."""


@dataclass(frozen=True)
class Case:
    """Sensors on a motion that is known.

    Attributes:
        name: Of the motion.
        subject: The person.
        q: (T, nq) true configurations.
        posture: (nq,) posture while standing.
        standing, moving: What the sensors read.
    """

    name: str
    subject: Subject
    q: Array
    posture: Array
    standing: tuple[ImuReadings, ...]
    moving: tuple[ImuReadings, ...]

    def found(self, moving: Sequence[ImuReadings] | None = None) -> InertialMotion:
        """What the sensors tell."""
        return inertial_motion(
            self.moving if moving is None else moving,
            self.subject,
            standing=self.standing,
            posture=self.posture,
        )


def rows(context: Context) -> Iterator[Check]:
    """All of them."""
    for plan in ("squat",) if context.quick else ("walk", "squat", "jump"):
        yield from _synthetic_rows(synthetic(plan, 6.0 if context.quick else 60.0))
    for name in () if context.quick else REAL:
        yield from _real_rows(context, name)
    yield from _magnetometer_rows(synthetic("walk", 5.0), 1 if context.quick else 8)
    yield from _angles_rows(synthetic("walk", 10.0), 1 if context.quick else 8)
    yield from _opensense_rows(context)


@cache
def synthetic(plan: str, seconds: float, seed: int = 0) -> Case:
    """A synthetic person's movement.

    Args:
        plan: What the person does.
        seconds: For how long.
        seed: Chooses person, movement and sensors.
    """
    subject = synthesise_subject(seed)
    model = body_of(subject)
    posture = synthesise_motion(model, "stand", 2.0, RATE_HZ, seed).q[0]
    motion = synthesise_motion(model, plan, seconds, RATE_HZ, seed)
    course = motion.times_s, motion.q, motion.v, motion.a
    return _case(f"synthetic {plan}, {seconds:g} s", subject, course, posture, seed)


def _case(
    name: str, subject: Subject, course: tuple[Array, Array, Array, Array], posture: Array, seed: int
) -> Case:
    """Sensors on a person who stands, then moves.

    Args:
        name: Of the motion.
        subject: The person.
        course: (T,) times, (T, nq) configurations, (T, nv) velocities and accelerations.
        posture: (nq,) posture while standing.
        seed: Chooses how sensors are put on, and their errors.
    """
    model = HumanModel.of(subject)
    mounts = typical_mounts(model, seed=seed, turn_sd_rad=ASKEW_RAD)
    rest = np.zeros((round(STANDING_S * RATE_HZ), model.nv))
    still = np.arange(len(rest)) / RATE_HZ, np.tile(posture, (len(rest), 1)), rest, rest
    standing = virtual_imus(model, *still, mounts, errors=ERRORS, seed=seed)
    moving = virtual_imus(model, *course, mounts, errors=ERRORS, seed=seed)
    return Case(name, subject, course[1], posture, standing, moving)


def _synthetic_rows(case: Case) -> Iterator[Check]:
    """Flexions, their spreads, and the pelvis's path."""
    result = case.found().result
    yield from _flexion_rows(case, result.q, 4.0)
    apart, sd = _flexions(case, result.q), _stated(result)
    z = float(np.sqrt(np.mean((apart / sd) ** 2)))
    yield Check(f"{case.name}: flexion error / stated sd", z, np.inf, "<=")
    own, true = (q[:, :2] - q[0, :2] for q in (result.q, case.q))
    way = float(np.linalg.norm(np.diff(true, axis=0), axis=1).sum())
    if way > 2.0:
        off = float(np.linalg.norm(_turned_onto(own, true) - true, axis=1).max())
        yield Check(
            f"{case.name}: pelvis path, furthest off its {way:.0f} m", 100.0 * off / way, 2.0, "<=", "%"
        )


def _turned_onto(own: Array, true: Array) -> Array:
    """(T, 2) a path turned by the angle that fits it best: without magnetometers the heading at the start is free."""
    cross, dot = (own[:, 0] * true[:, 1] - own[:, 1] * true[:, 0]).sum(), (own * true).sum()
    angle = np.arctan2(cross, dot)
    return np.asarray(own @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]))


def _flexions(case: Case, q: Array) -> Array:
    """(T, 6) errors, degrees, after the first second."""
    clinical = ClinicalAngles(HumanModel.of(case.subject))
    chosen = [clinical.names.index(name) for name in SAGITTAL]
    apart = clinical.angles(q)[:, chosen] - clinical.angles(case.q)[:, chosen]
    return np.degrees(apart)[_settled(len(q)) :]


def _settled(frames: int) -> int:
    """Frames that do not count: a second, a tenth of a short recording."""
    return min(round(SETTLED_S * RATE_HZ), frames // 10)


def _stated(result: object) -> Array:
    from mbkf.io.results import Reconstruction

    assert isinstance(result, Reconstruction)
    chosen = [result.coordinate_names.index(name) for name in SAGITTAL]
    return np.degrees(result.angles_sd[_settled(result.frames) :, chosen])


def _flexion_rows(case: Case, q: Array, bound: float) -> Iterator[Check]:
    rms = np.sqrt((_flexions(case, q) ** 2).mean(axis=0))
    for name, value in zip(SAGITTAL, rms, strict=True):
        yield Check(f"{case.name}, no magnetometer: {name}", float(value), bound, "<=", "deg")


def _real_rows(context: Context, name: str) -> Iterator[Check]:
    """Virtual sensors on a reconstructed walk; loads against the plates, where these read."""
    source = SOURCES[name]
    folder = context.require_data() / source.folder
    forces = None if source.forces is None else folder / source.forces
    capture, static = (
        read_capture(folder / source.trial, forces=forces),
        read_capture(folder / str(source.static)),
    )
    subject = scale(static, mass_kg=source.mass_kg)
    made = reconstruct(capture, subject, settings=ReconstructSettings(smooth=True))
    stood = reconstruct(static, subject, settings=ReconstructSettings(filter="kinematic", smooth=False))
    known = np.isfinite(made.q).all(axis=1)
    course = made.times_s[known], made.q[known], made.v[known], made.a[known]
    case = _case(name, subject, course, stood.q[len(stood.q) // 2], 0)
    result = case.found().result
    yield from _flexion_rows(case, result.q, 5.0)
    plates = made.foot_source[known] == Source.MEASURED
    first = _settled(result.frames)
    off = np.where(plates, result.foot_wrench[:, :, 2] - made.foot_wrench[known][:, :, 2], np.nan)[first:]
    weight = GRAVITY_M_S2 * subject.mass_kg
    value = 100.0 * float(np.sqrt(np.nanmean(off**2))) / weight
    yield Check(f"{name}, no plates: vertical reaction of a foot", value, 8.0, "<=", "% BW")
    own, true = (
        np.stack([one.moments[:, one.coordinate_names.index(f"ankle_angle_{s}")] for s in "rl"], axis=1)
        for one in (result, made)
    )
    torque = np.where(plates, own - true[known], np.nan)[first:] / subject.mass_kg
    value = float(np.sqrt(np.nanmean(torque**2)))
    yield Check(f"{name}, no plates: ankle torque", value, 0.25, "<=", "N m/kg")


def _magnetometer_rows(case: Case, sensors: int) -> Iterator[Check]:
    """Each magnetometer made bad in two ways: it alone is named, and no angle changes."""
    sound = case.found()
    yield Check("magnetometers: sound ones accused", float(len(sound.disturbed_fields)), 0.0, "<=")
    named, changed = [], 0.0
    for k in range(sensors):
        for spoil in BAD.values():
            bad = list(case.moving)
            bad[k] = replace(bad[k], magnetic_field=spoil(bad[k].magnetic_field))
            found = case.found(bad)
            named.append([one.sensor for one in found.disturbed_fields] == [bad[k].name])
            apart = np.degrees(np.abs(found.result.angles - sound.result.angles))
            changed = max(changed, float(np.nanmax(apart)))
    yield Check(
        f"magnetometers: bad ones named, alone, of {len(named)}", float(sum(named)), float(len(named)), ">="
    )
    yield Check("magnetometers: furthest change of an angle by a bad one", changed, 0.5, "<=", "deg")


def _angles_rows(case: Case, sensors: int) -> Iterator[Check]:
    """The same for angles by orientations with magnetometers: flexions of other joints hardly change."""
    model = HumanModel.of(case.subject)
    joined = {
        angle.name: (joint.proximal, joint.distal)
        for joint in ClinicalAngles(model).joints
        for angle in joint.angles
    }

    def angles(moving: Sequence[ImuReadings]) -> ImuAngles:
        return imu_angles(moving, model, standing=case.standing, posture=case.posture)

    sound = angles(case.moving)
    yield Check("magnetometers, imu angles: sound ones accused", float(len(sound.warnings)), 0.0, "<=")
    named, changed, own = [], 0.0, 0.0
    for k in range(sensors):
        for spoil in BAD.values():
            bad = list(case.moving)
            bad[k] = replace(bad[k], magnetic_field=spoil(bad[k].magnetic_field))
            found = angles(bad)
            named.append(
                [text.split(":")[0] for text in found.warnings] == [f"magnetometer of {bad[k].name}"]
            )
            apart = np.degrees(np.abs(found.angles - sound.angles)).max(axis=0)
            for name in SAGITTAL:
                change = float(apart[found.names.index(name)])
                if bad[k].name in joined[name]:
                    own = max(own, change)
                else:
                    changed = max(changed, change)
    head = "magnetometers, imu angles"
    yield Check(f"{head}: bad ones named, alone, of {len(named)}", float(sum(named)), float(len(named)), ">=")
    yield Check(f"{head}: furthest change of another joint's flexion", changed, 0.5, "<=", "deg")
    yield Check(f"{head}: furthest change of a flexion beside the bad one", own, np.inf, "<=", "deg")


def _opensense_rows(context: Context) -> Iterator[Check]:
    """A real walk, its sensors strapped on the other way round, without headings."""
    readings = read_imu(context.require_data() / "imu_opensense_walk")
    subject = person_of_stature(*OPENSENSE)
    settings = AnglesSettings(from_file=True, hold_headings=False)
    reference = imu_angles(readings, HumanModel.of(subject), standing=(0.0, 0.5), settings=settings)
    result = inertial_motion(readings, subject, standing=(0.0, 0.5)).result
    for name in SAGITTAL:
        own = result.angles[:, result.coordinate_names.index(name)]
        off = own - reference.angles[: len(own), reference.names.index(name)]
        value = float(np.degrees(np.sqrt(np.nanmean(off**2))))
        yield Check(
            f"OpenSense walk, no magnetometer: {name} against its inverse kinematics", value, 5.0, "<=", "deg"
        )
