"""The beginning of a live run on inertial sensors: the person stands still for a second, which calibrates them."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.segments import segment_of
from mbkf.io.imu.mount import write_mounts
from mbkf.model.human import HumanModel
from mbkf.stream.run.resumed import ResumedSource
from mbkf.stream.run.still_start import StillStart
from mbkf.stream.source import FrameSource, StreamDescription, plausible_imus
from mbkf.trial.inertial.standing import carrier_first
from mbkf.trial.live.worn import STAND_S, LiveWorn, StandingSensors, live_worn

MOUNTS_FILE = "mounts.toml"


@dataclass(frozen=True)
class CalibratedSensors:
    """Sensors calibrated from a stream.

    Attributes:
        worn: The filter on them.
        source: The stream, beginning at the frame after those of standing.
        report: Account of the calibration, for live.json.
    """

    worn: LiveWorn
    source: ResumedSource
    report: dict[str, object]


class SensorStanding(StillStart[CalibratedSensors]):
    """Waits until the person stands still and calibrates the sensors; writes mounts.toml."""

    request = f"stand still for {STAND_S:g} s, upright, arms hanging"
    failed_state = "not calibrated"
    goal = "the person stood still"

    def __init__(
        self,
        source: FrameSource,
        source_name: str,
        model: HumanModel,
        folder: Path,
        say: Callable[[str], None],
        *,
        posture: Array | None = None,
        only: Sequence[str] = (),
    ) -> None:
        """A start that is not connected yet.

        Args:
            source: The source of frames.
            source_name: Name of the source, for messages and live.json.
            model: The person's body.
            folder: For the results.
            say: Takes sentences for the person.
            posture: (nq,) posture while standing; None for the neutral one.
            only: Sensors to use; by default all.
        """
        super().__init__(source, source_name, folder, say)
        self._model, self._posture, self._only = model, posture, tuple(only)

    def _begin(self, stream: StreamDescription) -> None:
        """Chooses the sensors.

        Raises:
            InvalidInput: There are no sensors, or two on one segment.
            UnknownName: A sensor's segment is not known, or there is no such sensor.
        """
        if not stream.sensors:
            raise InvalidInput(f"{stream.trial} brings no inertial sensors; follow markers with 'mbkf live'")
        for name in self._only:
            if name not in stream.sensors:
                raise UnknownName("sensor", name, stream.sensors)
        names = [name for name in stream.sensors if not self._only or name in self._only]
        segments = [segment_of(name, self._model.joints) for name in names]
        carrier_first(segments, segments[0])  # refuses a segment with two sensors
        self._chosen = [stream.sensors.index(name) for name in names]
        self._standing = StandingSensors(names, stream.rate_hz)
        self._turns: deque[Array] = deque(maxlen=self._standing.wanted)

    def _step(self, stop: threading.Event) -> CalibratedSensors | None:
        try:
            frame = self._read(stop)
        except EOFError:
            raise self._ended() from None
        if frame is not None:
            readings = np.full((len(self._chosen), 6), np.nan)
            if frame.imus is not None:
                readings = plausible_imus(frame.imus[self._chosen])[0]
            self._standing.push(readings)
            if frame.orientations is not None:
                self._turns.append(frame.orientations[self._chosen])
        return self._calibrated() if self._standing.enough else None

    def _hindrance(self) -> str:
        return self._standing.hindrance

    def _progress_report(self) -> dict[str, object]:
        return {"calibration": {"frames_in": self._frames_in, "waiting_for": self._standing.hindrance}}

    def _calibrated(self) -> CalibratedSensors:
        names = [self.stream.sensors[k] for k in self._chosen]
        readings = self._standing.readings()
        turns = np.array(self._turns) if len(self._turns) == len(readings) else None
        rate_hz = self.stream.rate_hz
        worn = live_worn(self._model, names, readings, rate_hz, self._posture, orientations=turns)
        write_mounts(worn.worn.mounts, self._folder / MOUNTS_FILE)
        worn = replace(worn, columns=tuple(self._chosen[k] for k in worn.columns))
        stream = replace(self.stream, sensors=tuple(names))
        report = {
            "mounts": MOUNTS_FILE,
            "sensors": {mount.name: mount.segment for mount in worn.worn.mounts},
            "gyro_bias_deg_s": {
                mount.name: [round(float(np.degrees(one)), 4) for one in bias]
                for mount, bias in zip(worn.worn.mounts, worn.worn.bias_rad_s, strict=True)
            },
            "frames_in": self._frames_in,
            "frames": len(readings),
            "events": self._events.plain(),
        }
        self._prompting.say(f"{len(names)} sensors calibrated; move")
        return CalibratedSensors(worn, ResumedSource(self._source, stream), report)
