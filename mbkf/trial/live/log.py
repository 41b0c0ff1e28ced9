"""The log of a live run: a row per answered frame, the plates' samples, limbs in doubt, and a description.

The results are made from these files alone, so nothing that was written is lost when a run breaks off.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.recfunctions import rename_fields
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.filters.record import blank
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.records import PlateReadings

FRAMES_FILE, PLATES_FILE, LIMBS_FILE, SUBJECT_FILE = "frames.log", "plates.log", "limbs.log", "subject.toml"
"""Files of the log's folder."""

MOST_MISSING, MISSING_PER_ROW = 60_000, 4
"""Between the rows of a log so many may be missing in all, and so many more for each that is there: ten minutes at
100 Hz. What follows a longer gap, or a number that does not rise, is left out; no number decides how much memory is
asked for."""


RENAMED = {
    "position_sd": "sd_q", "velocity_sd": "sd_v", "position_offset": "sd_q_offset", "velocity_offset": "sd_v_offset",
    "refused": "rejected", "readings": "nis_readings", "readings_by_kind": "nis_readings_by_kind",
}  # fmt: skip
"""Fields of older logs and their names today."""


@dataclass(frozen=True)
class LiveStream:
    """Description of a logged stream.

    Attributes:
        trial: Its name.
        rate_hz: Frame rate.
        start_time_s: Time of frame 0.
        plates: Its plates, without readings; sample 0 at their ``start_time_s``.
        sensors: (S,) inertial sensors that alone show the person; none where markers do.
        marker_names: Markers of the stream, followed or not; none where its points have no names.
    """

    trial: str
    rate_hz: float
    start_time_s: float
    plates: tuple[PlateReadings, ...]
    sensors: tuple[str, ...] = ()
    marker_names: tuple[str, ...] = ()


LIMBS_DTYPE = np.dtype([("doubt", "S4096")])
"""Type of a limb in doubt: JSON of a :class:`mbkf.io.limb_doubts.LimbDoubt`."""


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
        recording: Sequence[FrameLogWriter] = (),
    ) -> None:
        """Makes the log's folder.

        Args:
            folder: Folder to make.
            stream: Description of the stream.
            frames: Type of a row.
            settings: Settings of the run, as plain data.
            names: (M,) markers tracked.
            recording: Files of the recording of all that the stream brings, which the log closes.

        Raises:
            OSError: It cannot be written.
        """
        self.folder, self.recording = folder, tuple(recording)
        folder.mkdir(parents=True, exist_ok=True)
        header = {
            "trial": stream.trial,
            "rate_hz": stream.rate_hz,
            "start_time_s": stream.start_time_s,
            "plates": [described_plate(plate) for plate in stream.plates],
            "settings": settings,
            "markers": names,
            "sensors": list(stream.sensors),
            "stream_markers": list(stream.marker_names),
        }
        with ExitStack() as opened:

            def opens(name: str, dtype: np.dtype, described: dict[str, object]) -> FrameLogWriter:
                return opened.enter_context(FrameLogWriter(folder / name, dtype, described))

            self.frames = opens(FRAMES_FILE, frames, header)
            self.plates = opens(PLATES_FILE, plates_dtype(len(stream.plates)), {})
            self.limbs = opens(LIMBS_FILE, LIMBS_DTYPE, {})
            opened.pop_all()

    def close(self) -> None:
        """No more rows."""
        self.frames.close()
        self.plates.close()
        self.limbs.close()
        for one in self.recording:
            one.close()


@dataclass(frozen=True)
class Logged:
    """Contents of a log.

    Attributes:
        stream: Description of the stream, its plates with their readings.
        names: (M,) markers tracked.
        settings: Of the run.
        first: Number of its first frame.
        rows: (T,) one row per frame from there on; those of lost frames are blank.
        left_out: A sentence for each file of which rows are left out, since they or those before are damaged.
        limb_doubts: Limbs that were in doubt; times in s since the first frame.
    """

    stream: LiveStream
    names: tuple[str, ...]
    settings: dict[str, object]
    first: int
    rows: NDArray
    left_out: tuple[str, ...] = ()
    limb_doubts: tuple[LimbDoubt, ...] = ()


def read_live_log(folder: Path) -> Logged:
    """Reads what :class:`LiveLog` wrote, as far as it came and is undamaged.

    Raises:
        FileFormatError: The log is missing or holds no row.
    """
    log = read_frame_log(folder / FRAMES_FILE)
    header: dict[str, Any] = log.header
    rows = rename_fields(log.rows[: rising(log.rows["number"])], RENAMED)
    if not len(rows):
        raise FileFormatError(folder / FRAMES_FILE, "no frame was written")
    first = int(rows["number"][0])
    whole = blank(_aligned(rows.dtype), int(rows["number"][-1]) - first + 1)
    whole["number"] = first + np.arange(len(whole))
    whole[rows["number"] - first] = rows
    samples, samples_lost = _samples(folder / PLATES_FILE, len(header["plates"]))
    plates = plates_of(header, samples)
    stream = LiveStream(
        header["trial"],
        header["rate_hz"],
        header["start_time_s"],
        plates,
        tuple(header.get("sensors", ())),
        tuple(header.get("stream_markers", ())),
    )
    frames_lost = _loss(len(log.rows) - len(rows) + log.left_out, "frames", FRAMES_FILE)
    losses = tuple(sentence for sentence in (frames_lost, samples_lost) if sentence)
    doubts = _limb_doubts(folder / LIMBS_FILE)
    return Logged(stream, tuple(header["markers"]), header["settings"], first, whole, losses, doubts)


def _aligned(dtype: np.dtype) -> np.dtype:
    """The type of a row, padded so that the numbers of every row are aligned, as compiled functions read them."""
    return np.dtype([(name, dtype[name]) for name in dtype.names or ()], align=True)


def _samples(path: Path, plates: int) -> tuple[NDArray, str]:
    """Samples of the plates, none where their file is unreadable; and what of them is left out, in words."""
    try:
        log = read_frame_log(path)
    except FileFormatError as error:
        return np.zeros(0, dtype=plates_dtype(plates)), f"the plates' samples are left out: {error}"
    rows = log.rows[: rising(log.rows["index"])]
    return rows, _loss(len(log.rows) - len(rows) + log.left_out, "samples of the plates", PLATES_FILE)


def _limb_doubts(path: Path) -> tuple[LimbDoubt, ...]:
    """Limbs in doubt as far as they can be read; older logs have none."""
    if not path.is_file():
        return ()
    found = []
    with suppress(FileFormatError, InvalidInput, UnicodeDecodeError):
        for row in read_frame_log(path).rows:
            found.append(LimbDoubt.of_text(row["doubt"].decode()))
    return tuple(found)


def _loss(count: int, what: str, file: str) -> str:
    return f"{count} {what} are left out: {file} is damaged from there on" if count else ""


def rising(numbers: NDArray[np.int64]) -> int:
    """Number of rows from the first one on whose numbers rise and are not too far apart."""
    if len(numbers) < 2:
        return len(numbers)
    later = np.arange(1, len(numbers))
    missing = (
        numbers[1:].astype(float) - float(numbers[0]) - later
    )  # as floats: differences of integers may overflow
    wrong = (numbers[1:] <= numbers[:-1]) | (missing > MOST_MISSING + MISSING_PER_ROW * later)
    return 1 + int(wrong.argmax()) if wrong.any() else len(numbers)


def described_plate(plate: PlateReadings) -> dict[str, object]:
    """A plate as plain data, without its readings."""
    return {
        "name": plate.name,
        "rate_hz": plate.rate_hz,
        "start_time_s": plate.start_time_s,
        "origin_m": plate.origin_m.tolist(),
        "threshold_n": plate.threshold_n,
        "corners_m": None if plate.corners_m is None else plate.corners_m.tolist(),
    }


def plates_of(header: Mapping[str, object], samples: NDArray) -> tuple[PlateReadings, ...]:
    """The plates of a log's header with their readings; missing samples between others are NaN.

    Args:
        header: The header.
        samples: (S,) samples, of :func:`plates_dtype`, with rising numbers.
    """
    described: Any = header["plates"]
    return tuple(
        _with_readings(plate, samples["index"], samples["wrench"][:, k]) for k, plate in enumerate(described)
    )


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
