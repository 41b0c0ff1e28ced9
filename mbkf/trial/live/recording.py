"""The recording of a live run: all that the stream brought, row by row in the run's log, and a C3D file at its end.

Points without names stand in columns ``*1``, ``*2``, … in the order in which they came. C3D knows no missing samples of
plates: short gaps are bridged with straight lines, as in every trial, and longer ones hold 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.sensors.contact.cleaning import bridgeable
from mbkf.sensors.contact.faults import bridged
from mbkf.trial.live.log import LiveStream, described_plate, plates_dtype, plates_of, rising

MARKERS_FILE, POINTS_FILE, SAMPLES_FILE = "recorded_markers.log", "recorded_points.log", "recorded_plates.log"
"""Files in the log's folder."""

POINT_DTYPE = np.dtype([("number", "<i8"), ("point", "<f8", (3,)), ("residual", "<f4")])
"""Type of a point without a name: its frame, place, m, and residual, m, NaN where it is not known."""

MOST_POINTS = 1000
"""Points without names that are recorded of a frame, at most."""


class RecordingFiles(NamedTuple):
    """Writers of a recording.

    Attributes:
        markers: A row per frame that arrived: its number, all markers of the stream (M, 3), m, and their residuals
            (M,), m, NaN where they are not known.
        points: A row per point without a name.
        samples: A row per sample of the plates.
    """

    markers: FrameLogWriter
    points: FrameLogWriter
    samples: FrameLogWriter


def open_recording(folder: Path, stream: LiveStream, to: Path) -> RecordingFiles:
    """Begins a recording.

    Args:
        folder: The log's folder, which is there.
        stream: Description of the stream.
        to: The C3D file at the end.

    Raises:
        OSError: It cannot be written.
    """
    header: dict[str, object] = {
        "to": str(to.absolute()),
        "trial": stream.trial,
        "rate_hz": stream.rate_hz,
        "start_time_s": stream.start_time_s,
        "markers": list(stream.marker_names),
        "plates": [described_plate(plate) for plate in stream.plates],
    }
    count = len(stream.marker_names)
    rows = np.dtype([("number", "<i8"), ("markers", "<f8", (count, 3)), ("residuals", "<f4", (count,))])
    with ExitStack() as opened:

        def opens(name: str, dtype: np.dtype, described: dict[str, object]) -> FrameLogWriter:
            return opened.enter_context(FrameLogWriter(folder / name, dtype, described))

        files = RecordingFiles(
            opens(MARKERS_FILE, rows, header),
            opens(POINTS_FILE, POINT_DTYPE, {}),
            opens(SAMPLES_FILE, plates_dtype(len(stream.plates)), {}),
        )
        opened.pop_all()
    return files


@dataclass(frozen=True)
class Recorded:
    """A recording.

    Attributes:
        to: The C3D file that it becomes.
        capture: Its contents, from time 0 on.
        residuals_m: (T, N) the camera system's residuals of its points, NaN where they are not known.
        left_out: Sentences on what is left out or filled in.
    """

    to: Path
    capture: Capture
    residuals_m: Array
    left_out: tuple[str, ...] = ()


def read_recording(folder: Path) -> Recorded | None:
    """The recording in a log's folder as far as it is undamaged; None where the run was not recorded.

    Raises:
        FileFormatError: It is damaged from its beginning on, or holds no frame.
    """
    if not (folder / MARKERS_FILE).is_file():
        return None
    log = read_frame_log(folder / MARKERS_FILE)
    header: dict[str, Any] = log.header
    rows = log.rows[: rising(log.rows["number"])]
    if not len(rows):
        raise FileFormatError(folder / MARKERS_FILE, "no frame was written")
    first, count = int(rows["number"][0]), int(rows["number"][-1] - rows["number"][0]) + 1
    place = rows["number"] - first
    positions = np.full((count, len(header["markers"]), 3), np.nan)
    positions[place] = rows["markers"]
    residuals = np.full((count, len(header["markers"])), np.nan)
    residuals[place] = rows["residuals"]
    bare, bare_residuals, crowded = _points(folder / POINTS_FILE, first, count)
    names = [*header["markers"], *(f"*{k + 1}" for k in range(bare.shape[1]))]
    markers = MarkerTrajectories(
        tuple(names), np.concatenate([positions, bare], axis=1), header["rate_hz"], 0.0
    )
    begin_s = header["start_time_s"] + first / header["rate_hz"]
    plates, filled = _plates(folder / SAMPLES_FILE, header, begin_s)
    missing = len(log.rows) - len(rows) + log.left_out
    lost = f"recording: {missing} frames are left out: {MARKERS_FILE} is damaged from there on"
    full = (
        f"recording: {crowded} frames hold {MOST_POINTS} points without names; any further ones are left out"
    )
    sentences = ([lost] if missing else []) + ([full] if crowded else []) + filled
    capture = Capture(header["trial"], markers, plates)
    every = np.concatenate([residuals, bare_residuals], axis=1)
    return Recorded(Path(header["to"]), capture, every, tuple(sentences))


def _points(path: Path, first: int, count: int) -> tuple[Array, Array, int]:
    """(T, N, 3) points without names, (T, N) residuals, NaN after a frame's last one, and the number of full frames."""
    rows = read_frame_log(path).rows
    frame = rows["number"] - first
    rows, frame = rows[(frame >= 0) & (frame < count)], frame[(frame >= 0) & (frame < count)]
    if not len(rows):
        return np.zeros((count, 0, 3)), np.zeros((count, 0)), 0
    starts = np.flatnonzero(np.diff(frame, prepend=-1))
    column = np.arange(len(frame)) - np.repeat(starts, np.diff(starts, append=len(frame)))
    points = np.full((count, int(column.max()) + 1, 4), np.nan)
    points[frame, column, :3], points[frame, column, 3] = rows["point"], rows["residual"]
    return points[:, :, :3], points[:, :, 3], int((column == MOST_POINTS - 1).sum())


def _plates(
    path: Path, header: Mapping[str, object], begin_s: float
) -> tuple[tuple[PlateReadings, ...], list[str]]:
    """The plates that sent anything, times since the first frame, and sentences on gaps."""
    rows = read_frame_log(path).rows
    rows = rows[: rising(rows["index"])]
    plates, sentences = [], []
    for plate in plates_of(header, rows) if len(rows) else ():
        wrench, zeros = _filled(np.hstack([plate.force_n, plate.moment_nm]), plate.rate_hz)
        if zeros:
            sentences.append(
                f"recording: {zeros} of {len(wrench)} samples of plate '{plate.name}' never came and are 0"
            )
        start_s = plate.start_time_s - begin_s
        plates.append(replace(plate, start_time_s=start_s, force_n=wrench[:, :3], moment_nm=wrench[:, 3:]))
    return tuple(plates), sentences


def _filled(wrench: Array, rate_hz: float) -> tuple[Array, int]:
    """Samples (S, 6) with straight lines over short gaps and zeros in longer ones, and the number of these."""
    bad = np.asarray(~np.isfinite(wrench).all(axis=1))
    long = bad & ~bridgeable(bad, rate_hz)
    return np.where(long[:, None], 0.0, bridged(wrench, bad)), int(long.sum())
