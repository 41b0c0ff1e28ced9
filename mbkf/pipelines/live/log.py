"""The log of a live run: a row per answered frame, the plates' samples, and the description of both.

The results are made from these three files alone, so nothing that was written is lost when a run breaks off.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.filters.estimate import Estimate, Follower
from mbkf.filters.spread import Spread
from mbkf.filters.tracking import Track
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.records import PlateReadings

FRAMES_FILE, PLATES_FILE, SUBJECT_FILE = "frames.log", "plates.log", "subject.toml"
"""Files of the log's folder."""

UNASKED = -9
"""Footing of a filter that does not ask for it."""


@dataclass(frozen=True)
class LiveStream:
    """Description of a logged stream.

    Attributes:
        trial: Its name.
        rate_hz: Frame rate.
        start_time_s: Time of frame 0.
        plates: Its plates, without readings; sample 0 at their ``start_time_s``.
    """

    trial: str
    rate_hz: float
    start_time_s: float
    plates: tuple[PlateReadings, ...]


class LogRows:
    """Makes rows of estimates."""

    def __init__(self, follower: Follower, markers: int, coordinates: int) -> None:
        """Rows of a filter's estimates.

        Args:
            follower: The filter.
            markers: Number of markers.
            coordinates: Number of clinical coordinates.
        """
        self._follower = follower
        nq, nv = follower.model.nq, follower.model.nv
        spread = {"position": nv, "velocity": nv, "angle": coordinates, "rate": coordinates, "torque": nv}
        self.dtype = np.dtype(
            [
                ("number", "<i8"),
                ("known", "?"),
                ("started", "?"),
                ("tracked", "?"),
                ("readings", "<i8"),
                ("footing", "<i8", (2,)),
                ("refused", "?", (markers,)),
                ("measured_m", "<f8", (markers, 3)),
                ("latency_s", "<f8"),
                ("step_seconds", "<f8"),
                ("nis", "<f8"),
                ("q", "<f8", (nq,)),
                ("v", "<f8", (nv,)),
                ("a", "<f8", (nv,)),
                ("wrench", "<f8", (2, 6)),
                ("wrench_sd", "<f8", (2, 6)),
                ("foot_height_sd", "<f8", (2,)),
                *((f"{name}_sd", "<f8", (size,)) for name, size in spread.items()),
            ]
        )
        self._empty = blank(self.dtype, 1)

    def row(
        self,
        number: int,
        measured_m: Array,
        estimate: Estimate | None,
        step_seconds: float,
    ) -> tuple[NDArray, Spread | None]:
        """(1,) a row of :attr:`dtype`, and the spread for :meth:`judge`.

        Args:
            number: The frame.
            measured_m: (M, 3) its markers.
            estimate: The filter's estimate.
            step_seconds: Computing time.
        """
        row = self._empty.copy()
        row["number"], row["measured_m"] = number, measured_m
        if estimate is None:
            return row, None
        row["known"], row["step_seconds"] = True, step_seconds
        row["started"], row["tracked"] = estimate.started, estimate.tracked
        row["refused"] = estimate.refused
        if estimate.footing is not None:
            row["footing"] = estimate.footing
        for name in ("q", "v", "a", "wrench"):
            row[name] = getattr(estimate, name)
        row["wrench_sd"] = self._follower.wrench_sd(estimate)
        spread = self._follower.spread(estimate)
        for name in ("position", "velocity", "torque"):
            row[f"{name}_sd"] = getattr(spread, name)
        return row, spread

    def judge(self, row: NDArray, estimate: Estimate | None, spread: Spread | None) -> None:
        """Adds how well the frame was predicted, and what only the results need; called after the frame was shown.

        Args:
            row: (1,) the frame's row.
            estimate: The filter's estimate, None where the body is not tracked.
            spread: Standard deviations of the estimate.
        """
        if estimate is None or spread is None:
            return
        row["nis"], row["readings"] = self._follower.innovation(estimate)
        for name in ("angle", "rate", "foot_height"):
            row[f"{name}_sd"] = getattr(spread, name)


def blank(dtype: np.dtype, rows: int) -> NDArray:
    """Empty rows: numbers NaN, flags off."""
    empty = np.zeros(rows, dtype=dtype)
    for name in dtype.names or ():
        if empty[name].dtype.kind == "f":
            empty[name] = np.nan
    empty["footing"] = UNASKED
    return empty


def plates_dtype(plates: int) -> np.dtype:
    """Type of a sample of all plates: its index and force N and moment N m about each plate's own origin."""
    return np.dtype([("index", "<i8"), ("wrench", "<f8", (plates, 6))])


class LiveLog:
    """Writes the folder of a running stream."""

    def __init__(
        self, folder: Path, stream: LiveStream, frames: np.dtype, settings: dict[str, Any], names: list[str]
    ) -> None:
        """Makes the log's folder.

        Args:
            folder: Folder to make.
            stream: Description of the stream.
            frames: Type of a row.
            settings: Settings of the run, as plain data.
            names: (M,) markers tracked.

        Raises:
            OSError: It cannot be written.
        """
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        header = {
            "trial": stream.trial,
            "rate_hz": stream.rate_hz,
            "start_time_s": stream.start_time_s,
            "plates": [_described(plate) for plate in stream.plates],
            "settings": settings,
            "markers": names,
        }
        self.frames = FrameLogWriter(folder / FRAMES_FILE, frames, header)
        self.plates = FrameLogWriter(folder / PLATES_FILE, plates_dtype(len(stream.plates)), {})

    def close(self) -> None:
        """No more rows."""
        self.frames.close()
        self.plates.close()


@dataclass(frozen=True)
class Logged:
    """Contents of a log.

    Attributes:
        stream: Description of the stream, its plates with their readings.
        names: (M,) markers tracked.
        settings: Of the run.
        first: Number of its first frame.
        rows: (T,) one row per frame from there on; those of lost frames are blank.
    """

    stream: LiveStream
    names: tuple[str, ...]
    settings: dict[str, Any]
    first: int
    rows: NDArray


def read_live_log(folder: Path) -> Logged:
    """Reads what :class:`LiveLog` wrote, as far as it came.

    Raises:
        FileFormatError: There is no log, or not one row in it.
    """
    header, rows = read_frame_log(folder / FRAMES_FILE)
    if not len(rows):
        raise FileFormatError(folder / FRAMES_FILE, "no frame was written")
    _, samples = read_frame_log(folder / PLATES_FILE)
    first = int(rows["number"][0])
    whole = blank(rows.dtype, int(rows["number"][-1]) - first + 1)
    whole["number"] = first + np.arange(len(whole))
    whole[rows["number"] - first] = rows
    plates = tuple(
        _with_readings(plate, samples["index"], samples["wrench"][:, k])
        for k, plate in enumerate(header["plates"])
    )
    stream = LiveStream(header["trial"], header["rate_hz"], header["start_time_s"], plates)
    return Logged(stream, tuple(header["markers"]), header["settings"], first, whole)


def track_of(rows: NDArray) -> Track:
    """The track of the trial, from the log's rows."""
    asked = rows["footing"][:, 0] != UNASKED
    names = ("q", "v", "a", "wrench", "wrench_sd", "nis", "readings", "step_seconds", "refused", "tracked")
    spread = ("position", "velocity", "angle", "rate", "torque", "foot_height")
    return Track(
        **{name: np.array(rows[name]) for name in (*names, *(f"{name}_sd" for name in spread))},
        footing=np.where(asked[:, None], rows["footing"], 0) if asked.any() else None,
        starts=tuple(int(t) for t in np.flatnonzero(rows["started"])),
        smoothed=False,
        covariance=None,
    )


def _described(plate: PlateReadings) -> dict[str, Any]:
    return {
        "name": plate.name,
        "rate_hz": plate.rate_hz,
        "start_time_s": plate.start_time_s,
        "origin_m": plate.origin_m.tolist(),
        "threshold_n": plate.threshold_n,
        "corners_m": None if plate.corners_m is None else plate.corners_m.tolist(),
    }


def _with_readings(plate: dict[str, Any], index: NDArray, wrench: Array) -> PlateReadings:
    """A plate from its description and samples (S, 6); missing ones between them are NaN."""
    first = int(index[0]) if len(index) else 0
    values = np.full((int(index[-1]) - first + 1 if len(index) else 0, 6), np.nan)
    values[index - first] = wrench
    return PlateReadings(
        name=plate["name"],
        rate_hz=plate["rate_hz"],
        start_time_s=plate["start_time_s"] + first / plate["rate_hz"],
        origin_m=np.array(plate["origin_m"]),
        force_n=values[:, :3],
        moment_nm=values[:, 3:],
        centre_of_pressure_m=np.full((len(values), 3), np.nan),
        threshold_n=plate["threshold_n"],
        corners_m=None if plate["corners_m"] is None else np.array(plate["corners_m"]),
    )
