"""The paper's two real experiments in kind: measured first steps of a public capture, and simulated slow steps.

The paper's recordings (one step of 0.70 m; steps of 0.50 and 0.70 m; an MPU-6050 on the toes, 50 Hz, one person who is
not described) are not public. In their place stand the first step and the first two steps of either foot of gaitmap's
healthy person, from standing still, with cameras as reference; and simulated steps with the paper's lengths and times.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.inertial.foot_walks import foot_walk
from benchmarks.inertial.stride_measured import (
    FOLDER,
    RATE_HZ,
    SMOOTHER,
    Compared,
    read_feet,
)
from benchmarks.stride_paper import printed
from mbkf.conventions import Array
from mbkf.imu.key_points import NOISY_WEIGHTS, KeyPointSettings, as_printed, follow_key_points
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.runs import runs
from mbkf.trial.inertial.stride import StrideSettings, measure_strides

CAMERA_HZ, MM = 100.0, 1e3

CUTS: dict[str, tuple[float, float]] = {"right_sensor": (2.05, 3.11), "left_sensor": (2.54, 3.62)}
"""Ends of the rests after the first and the second step of each foot, s."""

STANDING_S, BEFORE_END_S = 0.5, 0.1
"""Instants of the reference: in the first rest, and this long before the end of the last one."""

STARTS_S = (0.0, 0.5, 0.8)
"""Recordings that begin later have more of the first step within their first second."""

LAST_REST_S = (36.7, 38.5)
"""Standing at the end of the capture, whose mean angular velocity is the gyroscopes' bias."""

SAMPLE_BY_SAMPLE = KeyPointSettings(weights=NOISY_WEIGHTS, window=5, by_sample=True)
"""Of three variants the one that errs least on the strides of the same capture (benchmark ``inertial``)."""

METHODS: dict[str, KeyPointSettings] = {
    "as printed": as_printed(),
    "as printed, but zero velocity at key points": replace(as_printed(), zero_velocity=True),
    "as printed, but bias of the first rest": replace(as_printed(), bias_from="rest"),
    "ours": KeyPointSettings(weights=NOISY_WEIGHTS),
    "ours, windows of 5, sample by sample": SAMPLE_BY_SAMPLE,
}
KALMAN = "Kalman filter, smoothed"

SWITCHES: dict[str, KeyPointSettings] = {
    "ours": SAMPLE_BY_SAMPLE,
    "bias of the first second": replace(SAMPLE_BY_SAMPLE, bias_from="start"),
    "velocity runs through rests": replace(SAMPLE_BY_SAMPLE, zero_velocity=False),
    "both as the paper": replace(SAMPLE_BY_SAMPLE, bias_from="start", zero_velocity=False),
}

PITCH_RAD = (0.3, 0.9)
NOISE_M_S2, NOISE_RAD_S, BIAS_RAD_S = 0.06, 0.003, (0.02, -0.02, 0.02)
"""The noise of the paper's simulation, and a bias of 1.1°/s per axis."""


@dataclass(frozen=True)
class Recording:
    """Steps from standing.

    Attributes:
        name: Words of a table.
        kind: "one step" or "two steps".
        readings: Of the sensor.
        length_m: Straight way between the rests.
        course_m: (T,) true horizontal distance from the start, at ``course_s``.
        measured: Whether cameras measured it; else it is simulated.
    """

    name: str
    kind: str
    readings: ImuReadings
    length_m: float
    course_s: Array
    course_m: Array
    measured: bool


@dataclass(frozen=True)
class Estimated:
    """A method on a recording: lengths (n,) over the phases of its windows, m; one where it has none."""

    recording: Recording
    method: str
    lengths_m: Array

    @property
    def errors_m(self) -> Array:
        """(n,) estimated minus true."""
        return self.lengths_m - self.recording.length_m

    @property
    def rms_m(self) -> float:
        """RMS error over the phases."""
        return float(np.sqrt((self.errors_m**2).mean()))


def recordings(data: Path | None) -> list[Recording]:
    """Simulated slow steps, and the measured ones where there are captures.

    Args:
        data: Folder of the public captures.
    """
    return [*_simulated(), *([] if data is None else _measured(data / FOLDER))]


def _simulated() -> Iterator[Recording]:
    for kind, lengths in printed.STEPS_M.items():
        for pitch in PITCH_RAD:
            walk = foot_walk(
                lengths, rate_hz=printed.RATE_HZ, mounting_rad=(0.0, 0.0, 0.0), first_rest_s=printed.FIRST_REST_S,
                rest_s=printed.REST_S, swing_s=printed.STEP_S, pitch_rad=pitch,
                force_noise_m_s2=NOISE_M_S2, rate_noise_rad_s=NOISE_RAD_S, gyro_bias_rad_s=BIAS_RAD_S,
            )  # fmt: skip
            name = f"simulated, the paper's lengths and times, pitch to {np.degrees(0.476 * pitch):.0f}°"
            yield Recording(
                name, kind, walk.readings, sum(lengths), walk.readings.time_s, walk.position_m[:, 0], False
            )


def _measured(folder: Path) -> Iterator[Recording]:
    heel = _heels(folder)
    for foot in read_feet(folder):
        for kind, end in zip(printed.STEPS_M, CUTS[foot.name], strict=True):
            standing, at_end = round(CAMERA_HZ * STANDING_S), round(CAMERA_HZ * (end - BEFORE_END_S))
            moved = heel[foot.name][: round(CAMERA_HZ * end)] - heel[foot.name][standing]
            course = np.hypot(moved[:, 0], moved[:, 1])
            name = f"gaitmap, {foot.name.removesuffix('_sensor')} foot"
            seconds = np.arange(len(course)) / CAMERA_HZ
            yield Recording(name, kind, cut(foot, 0.0, end), float(course[at_end]), seconds, course, True)


def _heels(folder: Path) -> dict[str, Array]:
    """(T, 2) horizontal course of either heel, m, at the cameras' rate."""
    with (folder / "mocap_sample.csv").open(encoding="utf-8", newline="") as file:
        markers, axes, *rows = list(csv.reader(file))
    columns = {f"{marker} {axis}": k for k, (marker, axis) in enumerate(zip(markers, axes, strict=True))}
    table = np.array([[float(cell) for cell in row] for row in rows])
    return {
        f"{side}_sensor": table[:, [columns[f"{side[0].upper()}_FCC {axis}"] for axis in "xy"]] / MM
        for side in ("left", "right")
    }


def cut(readings: ImuReadings, start_s: float, end_s: float) -> ImuReadings:
    """The readings between two times.

    Args:
        readings: Of a sensor.
        start_s: First time.
        end_s: Last time.
    """
    kept = (readings.time_s >= start_s) & (readings.time_s <= end_s)
    return replace(
        readings,
        time_s=readings.time_s[kept],
        specific_force_mps2=readings.specific_force_mps2[kept],
        angular_velocity_rad_s=readings.angular_velocity_rad_s[kept],
    )


def estimate(found: Sequence[Recording]) -> list[Estimated]:
    """Every method on every recording.

    Args:
        found: The recordings.
    """
    estimated = []
    for one in found:
        for name, settings in METHODS.items():
            estimated.append(Estimated(one, name, over_phases(one.readings, settings)))
        estimated.append(Estimated(one, KALMAN, np.array([_kalman(one.readings)])))
    return estimated


def over_phases(readings: ImuReadings, settings: KeyPointSettings) -> Array:
    """(10,) horizontal way of the sensor for each phase of the first ten samples at the paper's rate.

    Args:
        readings: Of the sensor.
        settings: Windows, weights and equations.
    """
    return np.array([way(readings, replace(settings, first=first))[1][-1] for first in range(printed.WINDOW)])


def way(readings: ImuReadings, settings: KeyPointSettings) -> tuple[Array, Array]:
    """(K,) times and horizontal distance from the start by key points, m.

    Args:
        readings: Of the sensor.
        settings: Windows, weights and equations.
    """
    f, w = readings.specific_force_mps2, readings.angular_velocity_rad_s
    path = follow_key_points(f, w, readings.rate_hz, settings)
    return path.time_s, np.hypot(path.position_m[:, 0], path.position_m[:, 1])


def _kalman(readings: ImuReadings) -> float:
    return float(kalman_way(readings)[1][-1])


def kalman_way(readings: ImuReadings) -> tuple[Array, Array]:
    """(T,) times and horizontal distance from the start by the smoothed Kalman filter, m.

    Args:
        readings: Of the sensor.
    """
    foot = measure_strides([readings], StrideSettings("smoother")).feet[0]
    known = np.isfinite(foot.position_m[:, 0])
    moved = foot.position_m[known] - foot.position_m[known][0]
    return foot.time_s[known], np.hypot(moved[:, 0], moved[:, 1])


@dataclass(frozen=True)
class LateStart:
    """The measured steps, recorded from a later instant on, with the paper's choices one at a time.

    Attributes:
        start_s: The instant.
        rms_m: RMS error over both feet, both recordings and ten phases, by the name of the choice.
        bias_rad_s: Largest error of the bias, by its source.
    """

    start_s: float
    rms_m: dict[str, float]
    bias_rad_s: dict[str, float]


def late_starts(found: Sequence[Recording], data: Path) -> list[LateStart]:
    """Every start.

    Args:
        found: Measured recordings.
        data: Folder of the public captures.
    """
    true = {
        foot.name: cut(foot, *LAST_REST_S).angular_velocity_rad_s.mean(axis=0)
        for foot in read_feet(data / FOLDER)
    }
    return [_late_start(start, found, true) for start in STARTS_S]


def _late_start(start_s: float, found: Sequence[Recording], true: dict[str, Array]) -> LateStart:
    later = [replace(one, readings=cut(one.readings, start_s, np.inf)) for one in found]
    rms = {}
    for name, settings in SWITCHES.items():
        off = [over_phases(one.readings, settings) - one.length_m for one in later]
        rms[name] = float(np.sqrt((np.concatenate(off) ** 2).mean()))
    bias = {
        source: max(float(np.abs(measure(one.readings) - true[one.readings.name]).max()) for one in later)
        for source, measure in (("first rest", _bias_of_first_rest), ("first second", _bias_of_first_second))
    }
    return LateStart(start_s, rms, bias)


def _bias_of_first_second(readings: ImuReadings) -> Array:
    begin = float(readings.time_s[0])
    mean: Array = cut(readings, begin, begin + 1.0).angular_velocity_rad_s.mean(axis=0)
    return mean


def _bias_of_first_rest(readings: ImuReadings) -> Array:
    begin = float(readings.time_s[0])
    path = follow_key_points(
        readings.specific_force_mps2, readings.angular_velocity_rad_s, readings.rate_hz, SAMPLE_BY_SAMPLE
    )
    first, stop = runs(path.still)[0]
    rest = cut(
        readings, begin + path.time_s[first], begin + min(path.time_s[stop - 1], path.time_s[first] + 1.0)
    )
    mean: Array = rest.angular_velocity_rad_s.mean(axis=0)
    return mean


@dataclass(frozen=True)
class Signals:
    """Shares of the capture's signals and times.

    Attributes:
        below_5_hz, below_15_hz: Share of the variance of the specific force in walking.
        swing: Share of a stride from toe-off to contact, median, by the events of the cameras.
        stride_s: Time of a stride, median.
        stride_rmse_mm: RMS error of the Kalman filter's strides against the cameras.
        strides: How many.
    """

    below_5_hz: float
    below_15_hz: float
    swing: float
    stride_s: float
    stride_rmse_mm: float
    strides: int


def signals(data: Path, compared: Sequence[Compared]) -> Signals:
    """The whole capture of gaitmap.

    Args:
        data: Folder of the public captures.
        compared: Its strides by every method.
    """
    from scipy.signal import welch

    folder = data / FOLDER
    feet = read_feet(folder)
    power: list[Array] = []
    for foot in feet:
        walking = cut(foot, STANDING_S, float(foot.time_s[-1]) - 2.5)
        hz, density = welch(walking.specific_force_mps2, walking.rate_hz, nperseg=1024, axis=0)
        power.append(density.sum(axis=1))
    total = np.sum(power, axis=0)
    shares = [float(total[(hz > 0.0) & (hz <= most)].sum() / total[hz > 0.0].sum()) for most in (5.0, 15.0)]
    smoother = next(one for one in compared if one.name == SMOOTHER)
    swing_s, stride_s = _swings(folder)
    return Signals(
        shares[0],
        shares[1],
        float(np.median(swing_s / stride_s)),
        float(np.median(stride_s)),
        smoother.rmse_mm,
        smoother.found,
    )


def _swings(folder: Path) -> tuple[Array, Array]:
    """(n,) times of the swings and of the strides, s."""
    with (folder / "stride_events_sample.csv").open(encoding="utf-8", newline="") as file:
        events = list(csv.DictReader(file))
    before, leaves, lands = (
        np.array([float(event[key] or "nan") for event in events]) / RATE_HZ for key in ("pre_ic", "tc", "ic")
    )
    known = np.isfinite(before)
    return (lands - leaves)[known], (lands - before)[known]
