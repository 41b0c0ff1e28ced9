"""Virtual sensors on a body: joint angles from eight sensors alone, and the gain of sensors beside markers.

Truth is the motion the readings were made from: the synthetic walk, and the Rajagopal walk as the dynamic filter with
its smoother reconstructed it. Standing calibration knows the posture, as a static trial with markers gives it; a row
for information takes the neutral posture instead, and then errs by what the person stands otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.dynamic.captures import SOURCES
from mbkf.conventions import Array, BoolArray
from mbkf.imu.orientation import OrientSettings
from mbkf.imu.orientation_ekf import OrientationSettings
from mbkf.imu.placement import EIGHT, typical_mounts
from mbkf.imu.virtual import virtual_imus
from mbkf.io.capture import read_capture
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.cameras import occlusions
from mbkf.synthesis.capture import SyntheticCapture, synthesise_capture
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.inertial.angles import AnglesSettings, imu_angles
from mbkf.trial.inertial.on_body import ImuOnBody
from mbkf.trial.inertial.synth import BodyMotion
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

SAGITTAL = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")
STANDING_S, RATE_HZ = 5.0, 100.0
HIDDEN_SHARE, ALONE_S = 0.27, (3.0, 5.0)
SETTLED_S = 5.0


@dataclass(frozen=True)
class SensorMounts:
    """A motion, the standing posture before it, and the sensors' readings in both."""

    name: str
    motion: BodyMotion
    posture: Array
    walking: tuple[ImuReadings, ...]
    standing: tuple[ImuReadings, ...]


def worn(name: str, motion: BodyMotion, posture: Array, seed: int = 0) -> SensorMounts:
    """Sensors with random misalignment on a moving body, and on the body standing still.

    Args:
        name: Name of the trial.
        motion: The body's motion.
        posture: (nq,) posture in which it stands.
        seed: Random seed of misalignments and noise.
    """
    model, still = motion.model, np.zeros((round(STANDING_S * RATE_HZ), motion.model.nv))
    mounts = typical_mounts(model, seed=seed)
    times = np.arange(len(still)) / RATE_HZ
    posture_course = np.tile(posture, (len(still), 1))
    standing = virtual_imus(model, times, posture_course, still, still, mounts, seed=seed)
    walking = virtual_imus(model, motion.times_s, motion.q, motion.v, motion.a, mounts, seed=seed)
    return SensorMounts(name, motion, posture, walking, standing)


def angle_rows(context: Context) -> Iterator[Check]:
    """Sagittal hip, knee and ankle angles from eight sensors with magnetometers."""
    yield from _angle_rows(synthetic_walk(10.0 if context.quick else 60.0), long=not context.quick)
    if not context.quick:
        yield from _angle_rows(rajagopal_walk(context), long=False)


def synthetic_walk(seconds: float) -> SensorMounts:
    """The synthetic person standing, then walking."""
    model = body_of(synthesise_subject(0))
    stand = synthesise_motion(model, "stand", 2.0, RATE_HZ, 0)
    walk = synthesise_motion(model, "walk", seconds, RATE_HZ, 0)
    motion = BodyMotion(model, walk.times_s, walk.q, walk.v, walk.a)
    return worn(f"synthetic walk, {seconds:g} s", motion, stand.q[0])


def rajagopal_walk(context: Context) -> SensorMounts:
    """The reconstructed walk, and the posture of its static trial."""
    source = SOURCES["rajagopal walk"]
    folder = context.require_data() / source.folder
    capture = read_capture(folder / source.trial, forces=folder / str(source.forces))
    static = read_capture(folder / str(source.static))
    subject = scale(static, mass_kg=source.mass_kg)
    made = reconstruct(capture, subject, settings=ReconstructSettings(smooth=True))
    stood = reconstruct(static, subject, settings=ReconstructSettings(filter="kinematic", smooth=False))
    model = HumanModel.of(subject)
    known = np.isfinite(made.q).all(axis=1)
    motion = BodyMotion(model, made.times_s[known], made.q[known], made.v[known], made.a[known])
    return worn(
        f"rajagopal walk, {motion.times_s[-1] - motion.times_s[0]:.1f} s", motion, stood.q[len(stood.q) // 2]
    )


def _angle_rows(one: SensorMounts, long: bool) -> Iterator[Check]:
    smooth = AnglesSettings()
    live = AnglesSettings(OrientSettings("ekf", ekf=OrientationSettings(integrating=False)))
    for name, error in _errors(one, smooth, one.posture).items():
        yield Check(f"{one.name}, {name}", _rms(error), 4.0, "<=", "deg")
        if long:
            quarter = len(error) // 4
            drift = abs(float(error[-quarter:].mean() - error[:quarter].mean()))
            yield Check(
                f"{one.name}, {name}: last quarter's mean against the first's", drift, math.inf, "<=", "deg"
            )
    for label, settings, posture in (
        ("causal, after 5 s" if long else "causal", live, one.posture),
        ("by Madgwick's filter", AnglesSettings(OrientSettings("madgwick")), one.posture),
        ("headings not held", replace(smooth, hold_headings=False), one.posture),
        ("standing taken as neutral", smooth, None),
    ):
        errors = _errors(one, settings, posture)
        skip = round(SETTLED_S * RATE_HZ) if "after" in label else 0
        worst = max(errors, key=lambda key: _rms(errors[key][skip:]))
        yield Check(f"{one.name}, {label}: worst, {worst}", _rms(errors[worst][skip:]), math.inf, "<=", "deg")


def _errors(one: SensorMounts, settings: AnglesSettings, posture: Array | None) -> dict[str, Array]:
    """(T,) error of every sagittal angle, degrees."""
    found = imu_angles(
        one.walking, one.motion.model, standing=one.standing, posture=posture, settings=settings
    )
    clinical = ClinicalAngles(one.motion.model)
    truth = clinical.angles(one.motion.q)
    return {
        name: np.degrees(found.angles[:, found.names.index(name)] - truth[:, clinical.names.index(name)])
        for name in SAGITTAL
    }


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def marker_rows(context: Context) -> Iterator[Check]:
    """Markers with 27 % hidden, with and without sensors; and two seconds without any marker."""
    seeds = range(1 if context.quick else 2)
    ratios: dict[str, list[float]] = {}
    alone: dict[str, list[float]] = {}
    of_bodies: list[float] = []
    known: list[float] = []
    floor_mm = 0.0
    for seed in seeds:
        subject = synthesise_subject(seed)
        model = body_of(subject)
        motion = synthesise_motion(model, "walk", 6.0, RATE_HZ, seed)
        capture = synthesise_capture(subject, motion, seed=seed)
        mounts = typical_mounts(model, seed=seed)
        readings = virtual_imus(model, motion.times_s, motion.q, motion.v, motion.a, mounts, seed=seed)
        sensors = ImuOnBody(readings, mounts)
        carried = np.array([marker.segment in EIGHT for marker in subject.markers])
        groups = {"all markers": np.ones_like(carried), "markers on segments with sensors": carried}
        frames, count = capture.trial.markers.present.shape
        rng = np.random.default_rng([seed, 27])
        hidden = occlusions(frames, count, HIDDEN_SHARE, rng)
        hidden[: round(0.3 * RATE_HZ)] = False
        made = [_with_hidden(capture, subject, hidden, imus) for imus in (None, sensors, ImuOnBody(readings))]
        without, beside, own = (_marker_error(capture, one) for one in made)
        floor_mm = max(floor_mm, 1e3 * _mean_arms_error(model, capture, subject))
        gone = np.zeros_like(hidden)
        gone[round(ALONE_S[0] * RATE_HZ) : round(ALONE_S[1] * RATE_HZ)] = True
        lost = _marker_error(capture, _with_hidden(capture, subject, gone, sensors))
        of_body = [_body_error(capture, subject, one)[:, carried] for one in made[:2]]
        of_bodies.append(_rms(of_body[1][hidden[:, carried]]) / _rms(of_body[0][hidden[:, carried]]))
        exact = capture.trial.markers.positions_m - _true_markers(capture, subject)
        apart = np.linalg.norm(exact, axis=2)[:, carried]
        known.append(_rms(apart[hidden[:, carried] & np.isfinite(apart)]))
        for label, chosen in groups.items():
            base = _rms(without[:, chosen][hidden[:, chosen] & np.isfinite(without[:, chosen])])
            if label != "all markers":
                known[-1] /= base
            for kind, error in (("", beside), (" (mounts found from the markers)", own)):
                value = _rms(error[:, chosen][hidden[:, chosen] & np.isfinite(error[:, chosen])])
                ratios.setdefault(label + kind, []).append(value / base)
            alone.setdefault(label, []).append(
                1e3 * _rms(lost[:, chosen][gone[:, chosen] & np.isfinite(lost[:, chosen])])
            )
    yield Check(
        "beside it: true legs and trunk, arms at their mean of 2 s before", floor_mm, math.inf, "<=", "mm"
    )
    for label, values in ratios.items():
        bound = 0.7 if label == "markers on segments with sensors" else math.inf
        yield Check(f"27 % hidden, markers + 8 sensors / markers alone, {label}", max(values), bound, "<=")
    head = "27 % hidden, markers + 8 sensors / markers alone, markers on segments with sensors"
    yield Check(f"{head}: places on the body against their true ones", max(of_bodies), math.inf, "<=")
    yield Check(
        "27 % hidden: measured markers, which skin moves, from the true body / from markers alone",
        max(known),
        math.inf,
        "<=",
    )
    for label, values in alone.items():
        yield Check(f"sensors alone for 2 s, {label}", max(values), 60.0, "<=", "mm")


def _mean_arms_error(model: HumanModel, capture: SyntheticCapture, subject: Subject) -> float:
    """RMS over all markers, m, of a guess that knows everything but head, arms and toes, which keep their mean."""
    unknown = np.ones(model.nv, dtype=bool)
    for segment in EIGHT:
        unknown[model.joint(segment).v] = False
    q = capture.truth.q
    first, last = (round(RATE_HZ * time) for time in ALONE_S)
    before = range(max(0, 2 * first - last), first)
    mean = q[first - 1]
    for _ in range(5):
        mean = model.integrate(
            mean, np.mean([model.difference(mean, q[t]) * unknown for t in before], axis=0)
        )
    sensor = MarkerSensor(
        model, [m.segment for m in subject.markers], np.array([m.position_m for m in subject.markers])
    )
    apart = []
    for t in range(first, last):
        guess = model.integrate(q[t], model.difference(q[t], mean) * unknown)
        apart.append(np.linalg.norm(sensor.positions(guess) - sensor.positions(q[t]), axis=1))
    return _rms(np.array(apart))


def _true_markers(capture: SyntheticCapture, subject: Subject, q: Array | None = None) -> Array:
    """(T, M, 3) markers on the bones, m, of the true motion or of another one (T, nq)."""
    own = capture.truth.q if q is None else q
    sensor = MarkerSensor(
        body_of(subject),
        [m.segment for m in subject.markers],
        np.array([m.position_m for m in subject.markers]),
    )
    return np.array([sensor.positions(one) for one in own])


def _body_error(capture: SyntheticCapture, subject: Subject, made: Reconstruction) -> Array:
    """(T, M) distance of the markers' places on the reconstructed body from those on the true one, m."""
    apart = _true_markers(capture, subject, made.q) - _true_markers(capture, subject)
    return np.asarray(np.linalg.norm(apart, axis=2))


def _marker_error(capture: SyntheticCapture, made: Reconstruction) -> Array:
    """(T, M) distance of reconstructed and measured markers, m."""
    markers = capture.trial.markers
    error = np.full(markers.present.shape, np.nan)
    own = [markers.names.index(name) for name in made.marker_names]
    error[:, own] = np.linalg.norm(made.predicted_m - markers.positions_m[:, own], axis=2)
    return error


def _with_hidden(
    capture: SyntheticCapture, subject: Subject, hidden: BoolArray, imus: ImuOnBody | None
) -> Reconstruction:
    """The trial, causal, when some markers are hidden."""
    markers = capture.trial.markers
    shown = replace(markers, positions_m=np.where(hidden[:, :, None], np.nan, markers.positions_m))
    settings = ReconstructSettings(smooth=False)
    return reconstruct(replace(capture.trial, markers=shown), subject, settings=settings, imus=imus)
