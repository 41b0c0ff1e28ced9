"""The beginning of a live run on inertial sensors: the person stands still for a second, which calibrates them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.segments import segment_of
from mbkf.io.imu.mount import write_mounts
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.stream.receiving.reader import PAUSE_S, READ_S, SILENT_S
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.low_latency import low_latency
from mbkf.stream.run.prompting import Prompting
from mbkf.stream.run.report import LIVE_FILE, ReportFile
from mbkf.stream.run.resumed import ResumedSource
from mbkf.stream.source import FrameSource, StreamDescription, plausible_imus
from mbkf.trial.inertial.standing import carrier_first
from mbkf.trial.live.worn import STAND_S, LiveWorn, StandingSensors, live_worn

MOUNTS_FILE = "mounts.toml"

REPORT_S = 0.5
"""Interval at which live.json is brought up to date."""


@dataclass(frozen=True)
class CalibratedSensors:
    """Sensors calibrated from a stream.

    Attributes:
        worn: The filter on them.
        source: The stream, beginning at the frame after those of standing.
        report: How they were calibrated, for live.json.
    """

    worn: LiveWorn
    source: ResumedSource
    report: dict[str, object]


class SensorStanding:
    """Waits until the person stands still and calibrates the sensors.

    Attributes:
        stream: The stream's description, with the chosen sensors, once the source is connected.
    """

    stream: StreamDescription

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
            source: Where frames come from.
            source_name: Name of the source, for messages and live.json.
            model: The person's body.
            folder: For the results.
            say: Takes sentences for the person.
            posture: (nq,) posture while standing; None for the neutral one.
            only: Sensors to use; by default all.
        """
        self._source, self._source_name, self._model, self._folder = source, source_name, model, folder
        self._posture, self._only = posture, tuple(only)
        self._events = EventLog()
        self._prompting = Prompting(say, self._events)
        self._heard_s = self._events.begin_s
        self._frames_in = 0

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source; False where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most; None for as long as it takes.

        Raises:
            InvalidInput: The source did not appear in time, or its sensors cannot be a person's.
            UnknownName: A sensor's segment is not known, or there is no such sensor.
            MbkfError: The stream cannot be read.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is None:
            return False
        if not found.sensors:
            raise InvalidInput(f"{found.trial} brings no inertial sensors; follow markers with 'mbkf live'")
        for name in self._only:
            if name not in found.sensors:
                raise UnknownName("sensor", name, found.sensors)
        names = [name for name in found.sensors if not self._only or name in self._only]
        segments = [segment_of(name, self._model.joints) for name in names]
        carrier_first(segments, segments[0])  # refuses a segment with two sensors
        self._chosen = [found.sensors.index(name) for name in names]
        self.stream = found
        self._standing = StandingSensors(names, found.rate_hz)
        return True

    def find(self, stop: threading.Event, patience_s: float | None = None) -> CalibratedSensors | None:
        """Reads the stream until the person has stood still; writes mounts.toml. None where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most.

        Raises:
            InvalidInput: The source ended, or the time was over, before the person stood still.
            OSError: Nothing can be written to the folder.
        """
        report = ReportFile(self._folder / LIVE_FILE)
        self._prompting.say(f"stand still for {STAND_S:g} s, upright, arms hanging")
        try:
            with single_threaded(), low_latency():
                found = self._look(stop, patience_s, report)
        except InvalidInput as error:
            report.write(self._report("not calibrated", ended_by=str(error)), last=True)
            raise
        if found is None:
            report.write(self._report("not calibrated", ended_by="it was stopped"), last=True)
        return found

    def _look(
        self, stop: threading.Event, patience_s: float | None, report: ReportFile
    ) -> CalibratedSensors | None:
        begin_s, written_s = time.perf_counter(), 0.0
        while not stop.is_set():
            now = time.perf_counter()
            if now - written_s >= REPORT_S:
                report.write(self._report("standing"))
                written_s = now
            self._read(stop)
            if self._standing.enough:
                return self._calibrated()
            silent = time.perf_counter() - self._heard_s > SILENT_S
            self._prompting.waiting("no frames come from the stream" if silent else self._standing.hindrance)
            if patience_s is not None and now - begin_s > patience_s:
                raise InvalidInput(
                    f"nobody stood still within {patience_s:.0f} s: {self._standing.hindrance}"
                )
        return None

    def _read(self, stop: threading.Event) -> None:
        """Takes the next frame; an error of the source does not end the run.

        Raises:
            InvalidInput: The source has ended.
        """
        try:
            frame = self._source.read(READ_S)
        except EOFError:
            raise InvalidInput(
                f"the source ended before the person stood still: {self._standing.hindrance}"
            ) from None
        except Exception as error:  # libraries of sources raise errors of any kind
            self._events.note("source", f"the source failed ({type(error).__name__}: {error})")
            stop.wait(PAUSE_S)
            return
        for kind, what in self._source.news():
            self._events.note(kind, what)
        if frame is None:
            return
        self._frames_in += 1
        self._heard_s = time.perf_counter()
        readings = np.full((len(self._chosen), 6), np.nan)
        if frame.imus is not None:
            readings = plausible_imus(frame.imus[self._chosen])[0]
        self._standing.push(readings)

    def _calibrated(self) -> CalibratedSensors:
        names = [self.stream.sensors[k] for k in self._chosen]
        readings = self._standing.readings()
        worn = live_worn(self._model, names, readings, self.stream.rate_hz, self._posture)
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

    def _report(self, state: str, **more: object) -> dict[str, object]:
        return {
            "state": state,
            "source": self._source_name,
            "trial": self.stream.trial,
            "nominal_rate_hz": self.stream.rate_hz,
            "calibration": {"frames_in": self._frames_in, "waiting_for": self._standing.hindrance},
            **more,
            "events": self._events.plain(),
        }
