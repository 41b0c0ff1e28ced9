"""Inertial sensors on a live stream: calibrated while the person stands still, then followed by the filter alone.

Standing tells each sensor's tilt and its gyroscope's bias; its heading is taken to be as sensors are usually strapped
on, and the filter finds the rest while the person moves.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.mount_errors import MountErrors
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.imu.frames import conjugate, multiply
from mbkf.imu.heading import turned
from mbkf.imu.oriented_mounts import facing_of, oriented_mounts
from mbkf.imu.segment_course import configurations
from mbkf.imu.segments import segment_of
from mbkf.imu.sensor_to_segment import mean_orientation
from mbkf.imu.worn_mounts import MountSettings, SensorMounts, worn_mounts
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.human import HumanModel
from mbkf.trial.inertial.motion_inputs import MotionSettings, carrier, motion_inputs, worn_filter
from mbkf.trial.inertial.motion_start import StartSettings, first_posture
from mbkf.trial.inertial.standing import STILL_RAD_S, carrier_first
from mbkf.trial.preparation.filters import FilterInputs

STAND_S = 2.0
"""A person who has stood still for so long is calibrated: in less, sway is taken for gyroscopes' biases."""


@dataclass(frozen=True)
class LiveBodySensorSettings:
    """Settings of tracking from a stream of inertial sensors.

    Attributes:
        filter: Noise of the sensors, how still feet stand, how exactly Newton's law holds.
        mounts: How well mounts are known from standing.
        start: How well the posture while standing is known.
    """

    filter: MotionSettings = field(default_factory=MotionSettings)
    mounts: MountSettings = field(default_factory=MountSettings)
    start: StartSettings = field(default_factory=StartSettings)


@dataclass(frozen=True)
class LiveWorn:
    """A filter on inertial sensors, ready for the frame after those of standing.

    Attributes:
        columns: (S,) the stream's sensors that it takes, in its order.
        segments: (S,) segments that carry them.
        worn: How they sit, and their biases.
        inputs: Body and settings of the filter.
        filter: The filter.
        body: What its estimates err by because mounts are not known exactly.
        settings: Of the whole.
        heading_rad: Where the person faced while standing, in the world of the sensors' own orientations; None where
            these are not known.
    """

    columns: tuple[int, ...]
    segments: tuple[str, ...]
    worn: SensorMounts
    inputs: FilterInputs
    filter: TrackingFilter
    body: MountErrors
    settings: LiveBodySensorSettings
    heading_rad: float | None = None


class StandingSensors:
    """Collects frames until no sensor has turned for :data:`STAND_S`.

    Attributes:
        hindrance: What keeps the standing from being over, as a clause.
        wanted: Frames of standing that are needed.
    """

    def __init__(self, names: Sequence[str], rate_hz: float) -> None:
        """Args: the sensors, and the rate of their frames."""
        self._names, self.wanted = tuple(names), max(2, round(STAND_S * rate_hz))
        self._frames: deque[Array] = deque(maxlen=self.wanted)
        self.hindrance = "no sensor has read yet"

    def push(self, imus: Array) -> None:
        """Takes the next frame (S, 6); one that lacks a sensor's readings begins anew."""
        missing = [name for name, one in zip(self._names, imus, strict=True) if not np.isfinite(one).all()]
        if missing:
            self._frames.clear()
            self.hindrance = f"sensor {missing[0]} reads nothing"
            return
        self._frames.append(imus)
        turning = self._turning()
        worst = int(turning.argmax())
        if turning[worst] >= STILL_RAD_S:
            self.hindrance = f"sensor {self._names[worst]} turns at {np.degrees(turning[worst]):.0f} deg/s"
        else:
            self.hindrance = f"the person has stood still for less than {STAND_S:g} s"

    @property
    def enough(self) -> bool:
        """True once the person has stood still for long enough."""
        return len(self._frames) == self.wanted and bool((self._turning() < STILL_RAD_S).all())

    @property
    def progress(self) -> float:
        """Share of the standing that is over, 0 to 1."""
        still = bool(self._frames) and bool((self._turning() < STILL_RAD_S).all())
        return len(self._frames) / self.wanted if still else 0.0

    def readings(self) -> Array:
        """(T, S, 6) the frames of standing."""
        return np.array(self._frames)

    def _turning(self) -> Array:
        """(S,) root mean square angular velocity of each sensor, rad/s."""
        rates = np.array(self._frames)[:, :, :3]
        return np.asarray(np.sqrt((rates**2).sum(axis=2).mean(axis=0)))


def live_worn(
    model: HumanModel,
    names: Sequence[str],
    standing: Array,
    rate_hz: float,
    posture: Array | None = None,
    settings: LiveBodySensorSettings = LiveBodySensorSettings(),
    orientations: Array | None = None,
) -> LiveWorn:
    """Calibrates sensors on a person who stands, and prepares the filter.

    Args:
        model: The person's body.
        names: (S,) sensors of the stream, named after their segments.
        standing: (T, S, 6) what they read while the person stood still.
        rate_hz: Frame rate.
        posture: (nq,) the posture then; None for the neutral one.
        settings: Noise and priors.
        orientations: (T, S, 4) orientations of segments' own frames then, x forward, y left and z up in the neutral
            posture; None where they are not known.

    Raises:
        InvalidInput: A segment has two sensors.
        UnknownName: A sensor's segment is not known.
    """
    carriers = [segment_of(name, model.joints) for name in names]
    columns = tuple(carrier_first(carriers, carrier(model, carriers)))
    segments = tuple(carriers[k] for k in columns)
    times_s = np.arange(len(standing)) / rate_hz
    still = [
        ImuReadings(names[k], times_s, standing[:, k, 3:], standing[:, k, :3], None, rate_hz) for k in columns
    ]
    at_rest, known = (model.neutral(), False) if posture is None else (posture, True)
    heading = None
    if orientations is None:
        worn = worn_mounts(model, segments, still, still, at_rest, known, settings.mounts)
    else:
        stood = mean_orientation(orientations[:, list(columns)])
        heading = facing_of(stood[0])
        stood = turned(stood, np.full(len(columns), -heading))
        own = [one.name for one in still]
        worn = oriented_mounts(model, own, segments, stood, posture, settings.mounts)
        if posture is None:
            mounted = np.array([mount.rotation for mount in worn.mounts])
            at_rest = configurations(model, segments, multiply(stood, conjugate(mounted))[None])[0]
    inputs = motion_inputs(model, 1.0 / rate_hz, segments)
    first = first_posture(model, segments, np.tile(at_rest, (2, 1)), 1.0 / rate_hz, True, settings.start)
    filter = worn_filter(inputs, worn, first, settings.filter, posture, oriented=orientations is not None)
    body = MountErrors(model, segments, worn.turn_sd_rad)
    return LiveWorn(columns, segments, worn, inputs, filter, body, settings, heading)
