"""From the readings of one or two foot-mounted sensors to strides and the feet's paths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from mbkf.conventions import Array, BoolArray, StageCallback
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.checks import problems, refuse_fatal
from mbkf.imu.feet import placements
from mbkf.imu.foot_filter import FootFilterSettings, follow_foot
from mbkf.imu.foot_track import filtered_track, smoothed_track
from mbkf.imu.key_points import KeyPointSettings, follow_key_points
from mbkf.imu.soft_saturation import missing_turn_variance
from mbkf.imu.stride_doubts import doubted, out_of_reach
from mbkf.imu.strides import SHORTEST_M, Stride, find_strides
from mbkf.imu.worn_on_foot import elsewhere
from mbkf.imu.zero_velocity import StillnessSettings, rolling_samples, still_samples
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.runs import runs
from mbkf.version import __version__

METHODS = {
    "smoother": "Kalman filter with zero-velocity updates and backward smoother",
    "filter": "Kalman filter with zero-velocity updates",
    "key-points": "stability key points, gravity interpolation and double integration",
}

STRAIGHT_DEG = 20.0
"""Strides that turn the foot by more are left out of means."""


_MOST_TOLD = 3

LEAST_S = 1.0
"""Shorter captures hold no stride."""


@dataclass(frozen=True)
class StrideSettings:
    """Settings of stride measurement: ``method`` out of :data:`METHODS`, and those of its parts."""

    method: str = "smoother"
    stillness: StillnessSettings = field(default_factory=StillnessSettings)
    kalman: FootFilterSettings = field(default_factory=FootFilterSettings)
    key_points: KeyPointSettings = field(default_factory=KeyPointSettings)
    shortest_m: float = SHORTEST_M

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise UnknownName("method", self.method, METHODS)


@dataclass(frozen=True)
class FootResult:
    """One foot; T samples, or windows where the method works on windows.

    Attributes:
        name: The sensor's.
        rate_hz: Rate of its readings.
        time_s: (T,).
        position_m, velocity_m_s: (T, 3) x along the first stride, z up; NaN before the first rest.
        orientation: (T, 4) sensor → world as quaternions (x, y, z, w); None: the method gives no orientation.
        still: (T,) samples in which the foot stands.
        strides: In order of time.
        refused: Samples that looked like rest but contradicted the estimated velocity.
    """

    name: str
    rate_hz: float
    time_s: Array
    position_m: Array
    velocity_m_s: Array
    orientation: Array | None
    still: BoolArray
    strides: tuple[Stride, ...]
    refused: int = 0


@dataclass(frozen=True)
class StrideMeasurement:
    """Strides of one or two feet: a result per foot, the settings, and warnings about the readings."""

    feet: tuple[FootResult, ...]
    settings: StrideSettings
    notes: tuple[str, ...] = ()


def measure_strides(
    readings: Sequence[ImuReadings],
    settings: StrideSettings | None = None,
    *,
    progress: StageCallback | None = None,
) -> StrideMeasurement:
    """Strides and path of every foot, in one frame.

    Args:
        readings: One record per foot, on one clock.
        settings: Method and its parameters.
        progress: Called with the number of feet done.

    Raises:
        InvalidInput: No sensor, implausible readings, gaps, no gyroscope, a foot that never stands still, or a sensor
            that is worn elsewhere.
    """
    chosen = settings or StrideSettings()
    if not readings:
        raise InvalidInput("strides need at least one sensor on a foot")
    whole = [usable(reading) for reading in readings]
    notes = refuse_fatal(problems(whole))
    feet = []
    for n, reading in enumerate(whole):
        if progress is not None:
            progress("Following the feet", n, len(whole))
        try:
            feet.append(_follow(reading, chosen))
        except InvalidInput as error:
            raise InvalidInput(f"sensor {reading.name}: {error}") from error
    if progress is not None:
        progress("Following the feet", len(whole), len(whole))
    together = _within_reach(_together(feet))
    if any(foot.strides for foot in together) and not any(_accepted(foot.strides) for foot in together):
        first = next(stride for foot in together for stride in foot.strides)
        raise InvalidInput(
            f"no stride can be, the first one because {first.doubt}; the sensor needs to sit on the foot, "
            "and the foot to stand for a moment in every stride"
        )
    return StrideMeasurement(together, chosen, notes)


def usable(reading: ImuReadings) -> ImuReadings:
    """The readings, if they can be integrated.

    Raises:
        InvalidInput: The capture is too short for a stride, or the gyroscope or samples are missing.
    """
    where = f"sensor {reading.name}"
    if reading.samples < LEAST_S * reading.rate_hz:
        raise InvalidInput(
            f"{where}: {reading.samples} samples at {reading.rate_hz:g} Hz are too short for a stride; record at least "
            f"{LEAST_S:g} s"
        )
    if np.isnan(reading.angular_velocity_rad_s).all():
        raise InvalidInput(f"{where}: no gyroscope; export its readings, too")
    both = np.hstack([reading.specific_force_mps2, reading.angular_velocity_rad_s])
    lost = np.flatnonzero(~np.isfinite(both).all(axis=1))
    if len(lost):
        raise InvalidInput(
            f"{where}: {len(lost)} samples are missing, the first at {reading.time_s[lost[0]]:.3f} s; integration does "
            "not survive a gap, so cut the capture there"
        )
    jumps = np.flatnonzero(np.diff(reading.time_s) * reading.rate_hz > 1.5)
    if len(jumps):
        raise InvalidInput(
            f"{where}: the times jump at {reading.time_s[jumps[0]]:.3f} s, so samples were lost; integration does not "
            "survive a gap, so cut the capture there"
        )
    return reading


def _follow(reading: ImuReadings, settings: StrideSettings) -> FootResult:
    f, w, rate = reading.specific_force_mps2, reading.angular_velocity_rad_s, reading.rate_hz
    if settings.method == "key-points":
        start = float(reading.time_s[0])
        path = follow_key_points(f, w, rate, settings.key_points, start_s=start)
        strides = find_strides(path.time_s, path.position_m, path.still, shortest_m=settings.shortest_m)
        return FootResult(
            reading.name, rate, path.time_s, path.position_m, path.velocity_m_s, None, path.still, strides
        )
    still = still_samples(f, w, rate, settings.stillness)
    if reason := elsewhere(f, rate, still):
        raise InvalidInput(reason)
    rolling = rolling_samples(f, w, rate, still, settings.stillness)
    run = follow_foot(f, w, rate, still, settings.kalman, rolling, missing_turn_variance(reading))
    track = smoothed_track(run) if settings.method == "smoother" else filtered_track(run)
    strides = find_strides(
        reading.time_s,
        track.position_m,
        track.still,
        orientation=track.orientation,
        displacement_covariances_m2=track.displacement_covariances_m2,
        shortest_m=settings.shortest_m,
    )
    return FootResult(
        reading.name,
        rate,
        reading.time_s,
        track.position_m,
        track.velocity_m_s,
        track.orientation,
        track.still,
        strides,
        run.refused,
    )


def _accepted(strides: Sequence[Stride]) -> list[Stride]:
    return [stride for stride in strides if not stride.doubt]


def _within_reach(feet: Sequence[FootResult]) -> tuple[FootResult, ...]:
    """The feet with impossible strides, alone or beside the other foot, marked as refused."""
    own = [replace(foot, strides=doubted(foot.strides)) for foot in feet]
    if len(own) != 2:
        return tuple(own)
    return tuple(
        replace(
            foot,
            strides=out_of_reach(foot.strides, foot.time_s, foot.position_m, other.time_s, other.position_m),
        )
        for foot, other in (own, own[::-1])
    )


def _together(feet: Sequence[FootResult]) -> tuple[FootResult, ...]:
    """All feet in one frame."""
    ways = [
        foot.position_m[foot.strides[0].last] - foot.position_m[foot.strides[0].first]
        if foot.strides
        else np.zeros(3)
        for foot in feet
    ]
    found = placements([foot.time_s for foot in feet], [foot.position_m for foot in feet], ways)
    return tuple(
        replace(
            foot,
            position_m=place.of_points(foot.position_m),
            velocity_m_s=place.of_vectors(foot.velocity_m_s),
            orientation=None if foot.orientation is None else place.of_orientations(foot.orientation),
        )
        for foot, place in zip(feet, found, strict=True)
    )


def stride_summary(measured: StrideMeasurement) -> dict[str, object]:
    """Plain data for summary.json; null: unknown."""
    feet, settings = measured.feet, measured.settings
    summary: dict[str, object] = {
        "version": __version__,
        "method": settings.method,
        "method_meaning": METHODS[settings.method],
        "feet": {foot.name: _foot_numbers(foot) for foot in feet},
        "warnings": [*measured.notes, *(text for foot in feet for text in _warnings(foot))],
    }
    if len(feet) == 2:
        summary["both_feet"] = _both_numbers(feet)
    return summary


def _foot_numbers(foot: FootResult) -> dict[str, object]:
    straight = _straight(foot.strides)
    known = np.flatnonzero(np.isfinite(foot.position_m).all(axis=1))
    numbers: dict[str, object] = {
        "rate_hz": foot.rate_hz,
        "strides": len(foot.strides),
        "straight_strides": len(straight),
        "rests": len(runs(foot.still)),
        "rests_refused_samples": foot.refused,
        "strides_refused": len(foot.strides) - len(_accepted(foot.strides)),
        "distance_m": sum(stride.length_m for stride in _accepted(foot.strides)),
        "from_start_to_end_m": float(
            np.linalg.norm((foot.position_m[known[-1]] - foot.position_m[known[0]])[:2])
        ),
    }
    for name in ("length_m", "duration_s", "speed_m_s", "swing_s", "lift_m"):
        values = np.array([getattr(stride, name) for stride in straight])
        numbers[f"{name}_mean"] = float(values.mean()) if len(values) else None
        numbers[f"{name}_median"] = float(np.median(values)) if len(values) else None
        numbers[f"{name}_sd"] = float(values.std(ddof=1)) if len(values) > 1 else None
    return numbers


def _both_numbers(feet: Sequence[FootResult]) -> dict[str, object]:
    """Joint measures of both feet: step times from landing to landing, cadence, and symmetry."""
    landings = sorted(
        (float(foot.time_s[_landing(foot, stride)]), n)
        for n, foot in enumerate(feet)
        for stride in foot.strides
    )
    steps = [after - before for (before, one), (after, other) in pairwise(landings) if one != other]
    step = float(np.median(steps)) if steps else None
    one, two = (np.array([s.length_m for s in _straight(foot.strides)]) for foot in feet)
    alike = None
    if len(one) and len(two):
        alike = float(2.0 * (one.mean() - two.mean()) / (one.mean() + two.mean()))
    return {
        "first": feet[0].name,
        "second": feet[1].name,
        "steps": len(steps),
        "step_time_s_median": step,
        "cadence_steps_per_min": 60.0 / step if step else None,
        "length_asymmetry": alike,
    }


def _landing(foot: FootResult, stride: Stride) -> int:
    """First sample of the rest that ends a stride."""
    return next(start for start, stop in runs(foot.still) if start <= stride.last < stop)


def _straight(strides: Sequence[Stride]) -> list[Stride]:
    bound = np.radians(STRAIGHT_DEG)
    return [s for s in _accepted(strides) if np.isnan(s.turn_rad) or abs(s.turn_rad) <= bound]


def _warnings(foot: FootResult) -> list[str]:
    found = []
    if not foot.strides:
        found.append(f"{foot.name}: no stride found")
    if foot.still.any() and np.isfinite(foot.position_m[:, 0]).any():
        late = float(foot.time_s[int(foot.still.argmax())] - foot.time_s[0])
        if late > 1.0:
            found.append(f"{foot.name}: moves from the start; nothing is known of the first {late:.1f} s")
    refused = [stride for stride in foot.strides if stride.doubt]
    for stride in refused[:_MOST_TOLD]:
        found.append(f"{foot.name}: the stride at {stride.start_s:.2f} s is refused: {stride.doubt}")
    if len(refused) > _MOST_TOLD:
        found.append(f"{foot.name}: {len(refused) - _MOST_TOLD} more strides are refused")
    return found
