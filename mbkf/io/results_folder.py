"""The folder ``mbkf reconstruct`` writes: summary.json, motion.h5 and OpenSim's files, all or none."""

from __future__ import annotations

import json
import math
import uuid
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NotRequired, TypedDict, cast

from mbkf.errors import FileFormatError
from mbkf.io.atomic import write_text
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.files_read import SETTINGS_BYTES, read_text
from mbkf.io.hdf5 import run_of
from mbkf.io.plain_data import parse_json
from mbkf.io.results import Reconstruction
from mbkf.io.results_h5 import read_h5, read_h5_blocks, write_h5
from mbkf.io.results_opensim import OPENSIM_FILES, write_opensim
from mbkf.io.verdict import VerdictTold

SUMMARY_FILE = "summary.json"
MOTION_FILE = "motion.h5"
LABELS_FILE = "labels.json"
"""Labelling of the points of a trial, where its own names were not enough."""
RESULT_FILES = (SUMMARY_FILE, MOTION_FILE, *OPENSIM_FILES)
BLOCK = 2000
"""Frames of a block of a long result."""
RUN_ID = "run_id"
"""Key of summary.json, entry of the tables' headers and second line of motion.h5: the same in files of one run."""


class StatedAxes(TypedDict):
    """Axes of a capture as taken.

    Attributes:
        up, forward: Axes of the file that point up and forward.
        mirrored: Whether the file is left-handed, so that it was mirrored.
        source: Where that is known from: "plates", "screen", "default", "up given", "given", "body" or "made".
    """

    up: str
    forward: str
    mirrored: bool
    source: str


class ContactTold(TypedDict):
    """A stretch of time in which a part of the body bore load.

    Attributes:
        part: The part, e.g. "right_foot", "pelvis", "left_hand".
        from_s, to_s: Times of its first and its last frame.
        peak_n: Largest size of its force, N.
        sd_n: Mean standard deviation of the force along itself, N; None where not known.
        how: "measured" by a plate of its own, "shared" (a part of what one plate under both feet reads) or "estimated".
    """

    part: str
    from_s: float
    to_s: float
    peak_n: float
    sd_n: float | None
    how: str


class LimbDoubtTold(TypedDict):
    """A stretch in which a limb was in doubt, as in summaries (:class:`mbkf.io.limb_doubts.LimbDoubt`)."""

    limb: str
    kind: str
    from_s: float
    to_s: float
    joint: str
    beyond_rad: float
    misfit_m: float
    others_m: float
    mended: bool
    exchanged: list[list[str]]
    right_from_s: float | None


class UnexplainedTold(TypedDict):
    """A stretch of time in which the body moves as if a force acted on it that no contact gives.

    Attributes:
        from_s, to_s: Times of its first and its last frame.
        force_n, sd_n: Size of the mean force and its standard deviation, N.
        vector_n: (3,) the mean force on the body, world axes, N.
        direction: "upward", "downward", "horizontal", "obliquely upward" or "obliquely downward".
        share_of_weight: Its size over body weight.
        cause: "mass", "clock", "right_foot" or "left_foot" where that is likelier than a load, else "".
        hint: Meaning and remedy.
    """

    from_s: float
    to_s: float
    force_n: float
    sd_n: float
    vector_n: list[float]
    direction: str
    share_of_weight: float
    cause: str
    hint: str


class TrunkTold(TypedDict):
    """The trunk's extension moment at a level of the spine, over tracked frames.

    Attributes:
        peak_nm_per_kg, sd_nm: Largest size and mean standard deviation, top-down.
        bottom_up_peak_nm_per_kg, bottom_up_sd_nm: The same, bottom-up.
        difference_rms_nm_per_kg: Top-down minus bottom-up, RMS.
    """

    peak_nm_per_kg: float | None
    sd_nm: float | None
    bottom_up_peak_nm_per_kg: float | None
    bottom_up_sd_nm: float | None
    difference_rms_nm_per_kg: float | None


class Summary(TypedDict):
    """The contents of summary.json: the key numbers of a reconstruction; None where a number does not apply.

    Attributes:
        run_id: A number that all files of one run share; given when they are written.
        verdict: The parts of the result that may be used, and the reasons; None of a result that was not judged.
        trial, protocol, filter: Names of capture, protocol and filter.
        smoothed: Whether all later frames that matter were used.
        later_frames: The same in words: "smoothed (all later frames known)", "causal (as live)" or "fixed lag 60 ms".
        version: Version of mbkf.
        direction: What the frame of the pelvis's angles follows: "progression", "heading" or "laboratory".
        progression: That frame's kind in words, its heading, and how far it turns.
        mass_kg: Mass of the subject.
        frames, rate_hz, duration_s: Size of the trial.
        markers_used: Number of markers.
        markers_ignored: Why a marker of the capture was not used, by its name there.
        markers_explained: Share of the capture's named markers that the protocol knows, used or not, 0 to 1.
        names_exchanged: Two markers whose names were exchanged and are put right, and in how many frames.
        missing_fraction: Share of marker samples that the filter did not receive.
        marker_rms_mm, marker_max_mm: Distances of seen markers from the body.
        marker_rms_mm_by_name: The same by marker.
        hidden_marker_rms_mm, hidden_marker_max_mm: Distances of markers hidden on purpose.
        residual_force_rms_n, residual_moment_rms_nm: Residual at the pelvis in measured frames.
        residual_force_share, residual_lever_m: The same over body weight: a share, and a lever.
        valid_frames: Frames in which every contact that bears load is measured, or estimated so that the torques it
            loads are known well enough (:mod:`mbkf.trial.results.validity`), and in which no unexplained force acts.
        measured_frames: Frames in which plates measure every contact.
        contacts: Which part of the body bore load from when to when, how much, and how that is known.
        unexplained: Forces that no contact explains, from when to when, how much and whereto.
        limb_doubts: Limbs that fit their markers badly or lie beyond their ranges, from when to when, mended or not.
        plate_force_change_rms_n, plate_moment_change_rms_nm: Estimated minus measured plate wrenches.
        torque_peak_nm_per_kg, torque_sd_nm, torque_sd_offset_nm, torque_sd_varying_nm: Flexion torques by joint, their
            standard deviations, and the two parts of these (:data:`mbkf.io.results.SdPart`).
        trunk_moments: The trunk's extension moment by level of the spine.
        nis_per_dof: Normalised innovation squared per reading.
        nis: The same by kind of reading, and of Newton's law before correction.
        marker_noise_mm_by_name: Spread of one reading of each marker, as its innovations show it.
        step_seconds_median, step_seconds_p99: Computing time of a frame.
        realtime_factor: Duration over computing time.
        truth: Errors against a synthetic subject's known motion.
        axes: Axes of the capture's file.
        checks: What checks found that stand apart from the filter (:class:`mbkf.io.findings.Finding`).
        warnings: Remarks for the reader.
        settings: Settings of the run, as plain data.
    """

    run_id: NotRequired[str]
    verdict: VerdictTold | None
    trial: str
    protocol: str
    filter: str
    smoothed: bool
    later_frames: str
    version: str
    direction: str
    progression: dict[str, str | float]
    mass_kg: float
    frames: int
    rate_hz: float
    duration_s: float
    markers_used: int
    markers_ignored: dict[str, str]
    markers_explained: float
    names_exchanged: list[tuple[str, str, int]]
    missing_fraction: float | None
    marker_rms_mm: float | None
    marker_max_mm: float | None
    marker_rms_mm_by_name: dict[str, float | None]
    hidden_marker_rms_mm: float | None
    hidden_marker_max_mm: float | None
    residual_force_rms_n: float | None
    residual_moment_rms_nm: float | None
    residual_force_share: float | None
    residual_lever_m: float | None
    valid_frames: int
    measured_frames: int
    contacts: list[ContactTold]
    unexplained: list[UnexplainedTold]
    limb_doubts: list[LimbDoubtTold]
    plate_force_change_rms_n: float | None
    plate_moment_change_rms_nm: float | None
    torque_peak_nm_per_kg: dict[str, float | None]
    torque_sd_nm: dict[str, float | None]
    torque_sd_offset_nm: dict[str, float | None]
    torque_sd_varying_nm: dict[str, float | None]
    trunk_moments: dict[str, TrunkTold]
    nis_per_dof: float | None
    nis: dict[str, float]
    marker_noise_mm_by_name: dict[str, float | None]
    step_seconds_median: float | None
    step_seconds_p99: float | None
    realtime_factor: float | None
    truth: dict[str, float | None] | None
    axes: StatedAxes
    checks: list[dict[str, object]]
    warnings: list[str]
    settings: dict[str, object]


def write_reconstruction(
    reconstruction: Reconstruction, summary: Mapping[str, object], folder: str | Path
) -> Path:
    """Writes a reconstruction and its summary.

    The files replace those of an earlier result as one; other files of an existing folder stay.

    Args:
        reconstruction: The result.
        summary: Plain data for summary.json (:class:`Summary`, or a mapping of one's own); NaN becomes null.
        folder: Where to write; made where missing.

    Returns:
        The folder.

    Raises:
        FileFormatError: A file stands where the folder is needed, or a folder where a file is.
        OSError: The folder cannot be written to.
    """
    with replacing_folder(folder, last=SUMMARY_FILE) as partial:
        write_result_files(reconstruction, summary, partial)
    return Path(folder).absolute()


def write_result_files(reconstruction: Reconstruction, summary: Mapping[str, object], folder: Path) -> None:
    """Writes the files into a folder that is not in use yet.

    Args:
        reconstruction: The result.
        summary: Plain data for summary.json.
        folder: The folder; it exists.

    Raises:
        OSError: A file cannot be written.
    """
    run_id = uuid.uuid4().hex
    write_h5(reconstruction, folder / MOTION_FILE, run_id)
    write_opensim(reconstruction, folder, run_id)
    write_summary(summary, folder, run_id)


def write_summary(summary: Mapping[str, object], folder: Path, run_id: str) -> None:
    """Writes summary.json into a folder that is not in use yet.

    Args:
        summary: Plain data; NaN becomes null.
        folder: The folder; it exists.
        run_id: Number that the files of one run share.

    Raises:
        OSError: The file cannot be written.
    """
    plain = _without_nan({RUN_ID: run_id, **summary})
    text = json.dumps(plain, indent=2, allow_nan=False, ensure_ascii=False)
    write_text(folder / SUMMARY_FILE, text + "\n")


def read_reconstruction(path: str | Path) -> Reconstruction:
    """Reads a reconstruction from its folder, or from its motion.h5.

    Raises:
        FileFormatError: There is none, it is damaged, or the folder's files are of different runs.
    """
    return read_h5(_motion_of(path))


def read_blocks(path: str | Path) -> Iterator[Reconstruction]:
    """Reads a reconstruction in blocks of :data:`BLOCK` frames, so that a long one needs little memory.

    Remarks and attributes of each block are those of the whole.

    Args:
        path: Its folder, or its motion.h5.

    Raises:
        FileFormatError: There is none, it is damaged, or the folder's files are of different runs.
    """
    return read_h5_blocks(_motion_of(path), BLOCK)


def _motion_of(path: str | Path) -> Path:
    """The motion.h5 of a folder, or the file itself."""
    source = Path(path)
    if not source.is_dir():
        return source
    if not (source / MOTION_FILE).is_file():
        raise FileFormatError(source, f"the folder holds no {MOTION_FILE}; make it with 'mbkf reconstruct'")
    if (source / SUMMARY_FILE).is_file():
        read_summary(source)
    return source / MOTION_FILE


def read_summary(folder: str | Path) -> Summary:
    """The contents of a folder's summary.json.

    Raises:
        FileFormatError: It is missing or damaged, or motion.h5 beside it is of another run.
    """
    path, motion = Path(folder) / SUMMARY_FILE, Path(folder) / MOTION_FILE
    try:
        summary = parse_json(read_text(path, SETTINGS_BYTES))
        of_another_run = motion.is_file() and run_of(motion) != summary.get(RUN_ID, "")
    except (OSError, ValueError) as error:
        raise FileFormatError(path, f"cannot be read ({error}); make it with 'mbkf reconstruct'") from error
    if of_another_run:
        raise FileFormatError(
            Path(folder), f"{SUMMARY_FILE} and {MOTION_FILE} are of different runs; make them again"
        )
    return cast(Summary, summary)


def _without_nan(value: Any) -> Any:
    """Plain data with numpy's scalars as Python's and NaN and infinities as None."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, str | int | float | bool | None) else str(value)
