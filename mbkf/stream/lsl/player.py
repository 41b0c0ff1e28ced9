"""Plays a capture as Lab Streaming Layer streams: markers, or inertial sensors, and plates at their own rate."""

from __future__ import annotations

import numpy as np

from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import marker_info, plates_info
from mbkf.stream.lsl.sensor_format import sensor_info
from mbkf.stream.played import Played, PlayedFrame

KEPT_S = 10
"""Duration of samples that liblsl buffers for a slow receiver."""


class LslPlayer:
    """A :class:`mbkf.stream.replay.Player`."""

    def __init__(self, played: Played, name: str, speed: float = 1.0) -> None:
        """Opens the streams.

        Args:
            played: The capture.
            name: Name of the stream of markers, or of inertial sensors.
            speed: Times real time.
        """
        self._speed = speed
        self._begin_s: float | None = None
        self._lsl = lsl()
        self._stream = played.stream
        if self._stream.sensors:
            info = sensor_info(self._lsl, self._stream, name)
        else:
            info = marker_info(self._lsl, self._stream, name, played.markers_m.shape[1])
        self._plates = None
        if self._stream.plates:
            self._plates = self._lsl.StreamOutlet(
                plates_info(self._lsl, self._stream, name), max_buffered=KEPT_S
            )
        self._frames = self._lsl.StreamOutlet(info, max_buffered=KEPT_S)

    def listening(self) -> bool:
        """True once both streams are received."""
        outlets = [outlet for outlet in (self._frames, self._plates) if outlet is not None]
        return all(outlet.have_consumers() for outlet in outlets)

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends the plates' samples and then the frame, stamped with when they were taken."""
        stream, samples = self._stream, frame.plates
        if self._begin_s is None:
            self._begin_s = self._lsl.local_clock() - age_s - frame.number / (stream.rate_hz * self._speed)
        if self._plates is not None and len(samples.index):
            after_s = (
                stream.plates[0].start_time_s - stream.start_time_s + samples.index / stream.plate_rate_hz
            )
            rows = np.column_stack([samples.wrench.reshape(len(samples.index), -1), samples.index])
            self._plates.push_chunk(rows, list(self._begin_s + after_s / self._speed))
        read = frame.markers_m if frame.imus is None else frame.imus
        row = np.append(read.ravel(), frame.number)
        self._frames.push_sample(row, self._begin_s + frame.number / (stream.rate_hz * self._speed))

    def close(self) -> None:
        """Ends both streams."""
        self._frames = self._plates = None
