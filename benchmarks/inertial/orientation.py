"""Orientation filters on BROAD and on virtual sensors of the source's three movements; faults that must be detected.

BROAD is judged by its own protocol: root mean square over the movement phases, no alignment (Laidig et al. 2021).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from time import perf_counter

import numpy as np
import scipy.io

from benchmarks.checks import Check, Context
from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.imu.checks import problems
from mbkf.imu.madgwick import MadgwickFilter, MadgwickSettings
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.orientation_ekf import OrientationSettings
from mbkf.imu.orientation_error import OrientationError, error_angles, orientation_error
from mbkf.imu.placement import typical_mounts
from mbkf.imu.tuning import GainComparison, searched_gains, static_gains, still_stretch
from mbkf.imu.virtual import virtual_imus
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject

BETA = 0.1
BROAD = {
    "16": ("16_undisturbed_fast_translation_B.mat", (4.8, 2.7), (3.5, 1.2), 0.7),
    "21": ("21_undisturbed_fast_combined.mat", (7.1, 4.7), (5.0, 2.2), 1.3),
}
"""Per trial its file, plain Madgwick's total and inclination, the EKF's bounds, the offline bound on inclination."""

SOURCE_RATE_HZ = 60.0
SOURCE_GAINS = MadgwickSettings(0.35)
"""The source found zeta 0.07, too, but forgot to integrate what it multiplies, so that it had next to no effect."""
MOVEMENTS = {"walking": "walk", "sitting down": "sit_to_stand", "standing": "stand"}
SEGMENTS = ("right_thigh", "right_foot")
_TIMED = 5000
_CLIPPED = 30


def broad_rows(context: Context) -> Iterator[Check]:
    """Trials 16 and 21 of BROAD."""
    folder = context.require_data() / "imu_broad"
    for trial, (file, plain, online, offline) in BROAD.items():
        if context.quick and trial != "16":
            continue
        (one,) = read_imu(folder / file)
        moving = scipy.io.loadmat(folder / file)["movement"].ravel().astype(bool)
        name = f"BROAD {trial}"
        found = {method: _error(one, moving, OrientSettings(method, madgwick=MadgwickSettings(BETA)))
                 for method in ("madgwick", "ekf", "smooth")}  # fmt: skip
        for kind, known in zip(("total", "inclination"), plain, strict=True):
            value = math.degrees(getattr(found["madgwick"], kind))
            yield Check(f"{name}, Madgwick, beta {BETA}: {kind}", value, math.inf, "<=", "deg")
            yield Check(f"{name}, Madgwick: {kind} against {known}", abs(value / known - 1.0), 0.1, "<=")
        yield Check(f"{name}, Madgwick: furthest from ahrs", _from_ahrs(one, moving), 0.1, "<=", "deg")
        for kind, bound in zip(("total", "inclination"), online, strict=True):
            yield Check(f"{name}, EKF: {kind}", math.degrees(getattr(found["ekf"], kind)), bound, "<=", "deg")
        yield _shown(f"{name}, offline: total", found["smooth"].total)
        value = math.degrees(found["smooth"].inclination)
        yield Check(f"{name}, offline: inclination", value, offline, "<=", "deg")
        yield from _yardsticks(name, one, moving)
        turning = OrientSettings("ekf", ekf=OrientationSettings(rest_bias=False))
        yield _shown(f"{name}, EKF without rest bias: total", _error(one, moving, turning).total)
        yield from _tuning_rows(name, one, moving)


def _error(one: ImuReadings, moving: BoolArray, settings: OrientSettings) -> OrientationError:
    (course,) = orientations([one], frame="ENU", settings=settings)
    assert one.orientation is not None
    return orientation_error(course.quaternion, one.orientation, moving)


def _shown(name: str, angle_rad: float) -> Check:
    return Check(name, math.degrees(angle_rad), math.inf, "<=", "deg")


def _from_ahrs(one: ImuReadings, moving: BoolArray) -> float:
    """Greatest angle in degrees between the two Madgwick filters, from the same start."""
    from ahrs.filters import Madgwick

    theirs = Madgwick(
        gyr=one.angular_velocity_rad_s, acc=one.specific_force_mps2, mag=one.magnetic_field,
        frequency=one.rate_hz, gain=BETA,
    ).Q[:, [1, 2, 3, 0]]  # fmt: skip
    settings = OrientSettings("madgwick", madgwick=MadgwickSettings(BETA))
    (own,) = orientations([one], frame="NWU", settings=settings, start=theirs[:1])
    return float(np.degrees(error_angles(own.quaternion, theirs)[0][moving].max()))


def beside_vqf(context: Context) -> Iterator[Check]:
    """Both trials of BROAD by the EKF and its smoother, and by VQF online and offline."""
    folder = context.require_data() / "imu_broad"
    for trial, (file, *_) in BROAD.items():
        (one,) = read_imu(folder / file)
        moving = scipy.io.loadmat(folder / file)["movement"].ravel().astype(bool)
        name = f"BROAD {trial}"
        for kind, method in (("online", "ekf"), ("offline", "smooth")):
            error = _error(one, moving, OrientSettings(method, madgwick=MadgwickSettings(BETA)))
            yield _shown(f"{name}, mbkf {kind}: total", error.total)
            yield _shown(f"{name}, mbkf {kind}: inclination", error.inclination)
        yield from _yardsticks(name, one, moving)


def _yardsticks(name: str, one: ImuReadings, moving: BoolArray) -> Iterator[Check]:
    from vqf import VQF, offlineVQF

    assert one.orientation is not None
    parts = [
        np.ascontiguousarray(x)
        for x in (one.angular_velocity_rad_s, one.specific_force_mps2, one.magnetic_field)
    ]
    runs = {
        "VQF": VQF(1.0 / one.rate_hz).updateBatch(*parts),
        "VQF offline": offlineVQF(*parts, 1.0 / one.rate_hz),
    }
    for label, found in runs.items():
        error = orientation_error(found["quat9D"][:, [1, 2, 3, 0]], one.orientation, moving)
        yield _shown(f"{name}, {label} beside it: total", error.total)
        yield _shown(f"{name}, {label} beside it: inclination", error.inclination)


def _tuning_rows(name: str, one: ImuReadings, moving: BoolArray) -> Iterator[Check]:
    """What either tuning procedure gives, and what its gains then do."""
    assert one.orientation is not None
    gains = static_gains(one, *still_stretch(one))
    yield Check(f"{name}, tuned at rest: beta", gains.beta, math.inf, "<=")
    static = OrientSettings("madgwick", madgwick=MadgwickSettings(gains.beta, gains.zeta))
    yield _shown(f"{name}, tuned at rest: total", _error(one, moving, static).total)
    found = searched_gains(GainComparison(one, one.orientation, "ENU", moving))
    yield Check(f"{name}, searched: beta", found.settings.beta, math.inf, "<=")
    yield Check(f"{name}, searched: zeta", found.settings.zeta, math.inf, "<=")
    yield _shown(f"{name}, searched: total", found.error.total)
    theirs = OrientSettings("madgwick", madgwick=SOURCE_GAINS)
    yield _shown(f"{name}, the source's beta 0.35: total", _error(one, moving, theirs).total)


def source_rows(context: Context) -> Iterator[Check]:
    """Madgwick against the EKF on thigh and foot at 60 Hz, from the true start; time per sample."""
    model = body_of(synthesise_subject(0))
    methods = {
        "Madgwick 0.1": OrientSettings("madgwick", madgwick=MadgwickSettings(BETA)),
        "Madgwick 0.35": OrientSettings("madgwick", madgwick=SOURCE_GAINS),
        "EKF": OrientSettings("ekf", ekf=OrientationSettings(integrating=False)),
        "offline": OrientSettings("smooth", ekf=OrientationSettings(integrating=False)),
    }
    readings: tuple[ImuReadings, ...] = ()
    for movement, plan in MOVEMENTS.items():
        motion = synthesise_motion(model, plan, 6.0 if context.quick else 10.0, 120.0, 0)
        mounts = typical_mounts(model, SEGMENTS, seed=0)
        readings = virtual_imus(
            model, motion.times_s, motion.q, motion.v, motion.a, mounts, rate_hz=SOURCE_RATE_HZ
        )
        for label, settings in methods.items():
            truth = np.array([one.orientation[0] for one in readings if one.orientation is not None])
            courses = orientations(readings, frame="NWU", settings=settings, start=truth)
            for one, course in zip(readings, courses, strict=True):
                assert one.orientation is not None
                error = orientation_error(course.quaternion, one.orientation)
                yield _shown(f"{movement}, {one.name}, {label}: total", error.total)
                yield _shown(f"{movement}, {one.name}, {label}: inclination", error.inclination)
    yield from _time_rows(readings[0])


def _time_rows(one: ImuReadings) -> Iterator[Check]:
    """Time per sample, stepwise, one sensor with its magnetometer."""
    from ahrs.filters import Madgwick

    repeat = -(-_TIMED // one.samples)
    gyro, force, field = (
        np.tile(np.asarray(x), (repeat, 1))
        for x in (one.angular_velocity_rad_s, one.specific_force_mps2, one.magnetic_field)
    )
    long = ImuReadings(one.name, np.arange(len(gyro)) / one.rate_hz, force, gyro, field, one.rate_hz)
    own = MadgwickFilter(1.0 / one.rate_hz, MadgwickSettings(BETA))

    def live() -> None:
        state = own.begin(force[0], field[0])
        for k in range(1, len(gyro)):
            state = own.step(state, gyro[k], force[k], field[k])

    theirs = _best(lambda: Madgwick(gyr=gyro, acc=force, mag=field, frequency=one.rate_hz, gain=BETA))
    times = {
        "Madgwick, whole recording": _best(
            lambda: orientations([long], frame="NWU", settings=OrientSettings("madgwick"))
        ),
        "Madgwick, step by step": _best(live),
    }
    for label, seconds in times.items():
        yield Check(f"time per sample, {label} / ahrs", seconds / theirs, 1.0, "<=")
    kalman = _best(lambda: orientations([long], frame="NWU", settings=OrientSettings("ekf")))
    yield Check(
        "time per sample, EKF / Madgwick", kalman / times["Madgwick, whole recording"], math.inf, "<="
    )
    eight = _best(lambda: orientations([replace(long, name=str(k)) for k in range(8)], frame="NWU"))
    yield Check(
        "time per sample, EKF, of eight sensors together / alone", eight / kalman / 8.0, math.inf, "<="
    )


def _best(work: Callable[[], object]) -> float:
    """Shortest of three runs, s."""
    seconds = []
    for _ in range(3):
        start = perf_counter()
        work()
        seconds.append(perf_counter() - start)
    return min(seconds)


def fault_rows(context: Context) -> Iterator[Check]:
    """Faults put into real recordings: how many are detected by their kind, and the rate of false alarms."""
    data = context.require_data()
    feet = read_imu(
        data / "imu_gaitmap_foot" / "imu_sample.csv", units={"acc": "m/s2", "gyr": "deg/s"}, rate_hz=204.8
    )
    body = read_imu(data / "imu_qmt_fullbody" / "full_body_example_data.mat")
    board = read_imu(data / "imu_broad" / BROAD["21"][0])
    legs = tuple(one for one in body if "leg" in one.name or "foot" in one.name)
    sound = [*feet, *body, *board]
    accused = sum(any(problem.fatal for problem in problems([one])) for one in sound)
    yield Check(f"bad input: sound sensors accused, of {len(sound)}", float(accused), 0.0, "<=")
    for kind, spoil in _FAULTS.items():
        told = [
            any(problem.kind == kind.split()[0] for problem in problems(spoil(one)))
            for one in (*feet, *legs, *board)
        ]
        wanted = -math.inf if kind.startswith("sign") else 1.0
        yield Check(f"bad input: {kind} told, share of {len(told)}", float(np.mean(told)), wanted, ">=")


def _scaled(gyro: float = 1.0, force: float = 1.0) -> Callable[[ImuReadings], list[ImuReadings]]:
    return lambda one: [
        replace(
            one,
            angular_velocity_rad_s=gyro * one.angular_velocity_rad_s,
            specific_force_mps2=force * one.specific_force_mps2,
        )
    ]


def _gap(one: ImuReadings) -> list[ImuReadings]:
    force = one.specific_force_mps2.copy()
    force[one.samples // 2 : one.samples // 2 + 30] = np.nan
    return [replace(one, specific_force_mps2=force)]


def _stuck(one: ImuReadings) -> list[ImuReadings]:
    rates = one.angular_velocity_rad_s.copy()
    first = one.samples // 2
    rates[first : first + round(2.0 * one.rate_hz), 1] = rates[first, 1]
    return [replace(one, angular_velocity_rad_s=rates)]


def _clipped(one: ImuReadings) -> list[ImuReadings]:
    limit = float(np.sort(np.abs(one.angular_velocity_rad_s).max(axis=1))[-_CLIPPED])
    return [replace(one, angular_velocity_rad_s=np.clip(one.angular_velocity_rad_s, -limit, limit))]


def _slower(one: ImuReadings) -> list[ImuReadings]:
    half: Array = one.time_s[::2]
    other = ImuReadings(
        "other", half, one.specific_force_mps2[::2], one.angular_velocity_rad_s[::2], None, one.rate_hz / 2
    )
    return [one, other]


_FAULTS: dict[str, Callable[[ImuReadings], list[ImuReadings]]] = {
    "unit of the gyroscope, deg/s taken for rad/s,": _scaled(gyro=180.0 / math.pi),
    "unit of the gyroscope, rad/s taken for deg/s,": _scaled(gyro=math.pi / 180.0),
    "unit of the accelerometer, g taken for m/s²,": _scaled(force=1.0 / GRAVITY_M_S2),
    "sign of the gyroscope": _scaled(gyro=-1.0),
    "gap": _gap,
    "stuck axis": _stuck,
    "saturated gyroscope": _clipped,
    "rate unequal": _slower,
}
