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
from mbkf.filters.record import blank
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.records import PlateReadings

FRAMES_FILE, PLATES_FILE, SUBJECT_FILE = "frames.log", "plates.log", "subject.toml"
"""Files of the log's folder."""

LONGEST_GAP_S = 3600.0
"""What comes after a longer gap is left out of the results, which hold a row for every frame."""


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


def plates_dtype(plates: int) -> np.dtype:
    """Type of a sample of all plates: its index and force N and moment N m about each plate's own origin."""
    return np.dtype([("index", "<i8"), ("wrench", "<f8", (plates, 6))])


class LiveLog:
    """Writes the folder of a running stream."""

    def __init__(
        self,
        folder: Path,
        stream: LiveStream,
        frames: np.dtype,
        settings: dict[str, object],
        names: list[str],
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
        left_out: How many rows and samples were damaged, or came after too long a gap.
    """

    stream: LiveStream
    names: tuple[str, ...]
    settings: dict[str, object]
    first: int
    rows: NDArray
    left_out: int = 0


def read_live_log(folder: Path) -> Logged:
    """Reads what :class:`LiveLog` wrote, as far as it came.

    Raises:
        FileFormatError: There is no log, or not one row in it.
    """
    frames, plates_log = read_frame_log(folder / FRAMES_FILE), read_frame_log(folder / PLATES_FILE)
    header: dict[str, Any] = frames.header
    try:
        plate_hz = float(header["plates"][0]["rate_hz"]) if header["plates"] else 0.0
        rows = _without_leaps(frames.rows, "number", float(header["rate_hz"]))
        samples = _without_leaps(plates_log.rows, "index", plate_hz)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FileFormatError(folder / FRAMES_FILE, f"is no log of a live run ({error})") from error
    left_out = frames.damaged + plates_log.damaged
    left_out += len(frames.rows) - len(rows) + len(plates_log.rows) - len(samples)
    if not len(rows):
        raise FileFormatError(folder / FRAMES_FILE, "no frame was written")
    first = int(rows["number"][0])
    whole = blank(rows.dtype, int(rows["number"][-1]) - first + 1)
    whole["number"] = first + np.arange(len(whole))
    whole[rows["number"] - first] = rows
    plates = tuple(
        _with_readings(plate, samples["index"], samples["wrench"][:, k])
        for k, plate in enumerate(header["plates"])
    )
    stream = LiveStream(header["trial"], header["rate_hz"], header["start_time_s"], plates)
    return Logged(stream, tuple(header["markers"]), header["settings"], first, whole, left_out)


def _without_leaps(rows: NDArray, count: str, rate_hz: float) -> NDArray:
    """Rows up to the first one whose count does not go on, or goes on after too long a gap.

    Args:
        rows: The rows.
        count: Their field that counts.
        rate_hz: How often it counts.
    """
    steps = np.diff(rows[count])
    wrong = np.flatnonzero((steps <= 0) | (steps > LONGEST_GAP_S * rate_hz))
    return rows[: wrong[0] + 1] if len(wrong) else rows


def _described(plate: PlateReadings) -> dict[str, object]:
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
