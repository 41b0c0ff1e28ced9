"""Files of every format that mbkf reads, made by itself, with their readers and what their numbers may not be."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import data_folder
from mbkf.io.capture import read_capture, write_capture
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.imu_files import read_imu
from mbkf.io.preset import read_preset
from mbkf.io.records import Capture
from mbkf.io.results_folder import read_reconstruction, write_reconstruction
from mbkf.io.storage import read_storage
from mbkf.io.subject import read_subject
from mbkf.io.truth import read_truth
from mbkf.model.protocol import load_protocol
from mbkf.pipelines.batch.run import plan_of
from mbkf.pipelines.reconstruct import reconstruct
from mbkf.pipelines.results.summary import summarise
from mbkf.pipelines.synth import synthesise, write_folder

SECONDS = 1.0
MOST_M, MOST_N = 1e4, 1e6
"""Beyond these a place or a force is impossible."""


@dataclass(frozen=True)
class Format:
    """A format.

    Attributes:
        file: An undamaged file.
        read: Reads a file; returns whether what it holds is possible.
        text: Whether it is text.
    """

    file: Path
    read: Callable[[Path], bool]
    text: bool


def formats(folder: Path, data: Path | None = None) -> dict[str, Format]:
    """All formats by name, with files made in a folder.

    Args:
        folder: Where to make them; what was made there before is taken.
        data: Folder of the reference captures, for inertial sensors.
    """
    if not (folder / "trial.c3d").is_file():
        _make(folder)
    found = {
        "c3d": Format(folder / "trial.c3d", _capture, False),
        "trc": Format(folder / "trial.trc", _capture, True),
        "mot": Format(folder / "result" / "torques.sto", _table, True),
        "forces": Format(folder / "result" / "reactions.mot", _forces(folder / "trial.trc"), True),
        "subject": Format(folder / "subject.toml", _read(read_subject), True),
        "protocol": Format(folder / "set.toml", _read(load_protocol), True),
        "preset": Format(folder / "own.toml", _read(read_preset), True),
        "list": Format(folder / "list.toml", _read(plan_of), True),
        "list.csv": Format(folder / "list.csv", _read(plan_of), True),
        "motion": Format(folder / "result" / "motion.h5", _read(read_reconstruction), False),
        "truth": Format(folder / "truth.h5", _read(read_truth), False),
        "log": Format(folder / "frames.log", _read(read_frame_log), False),
    }
    if data is not None:
        found |= {
            "mat": Format(
                data / "imu_broad" / "16_undisturbed_fast_translation_B.mat", _read(read_imu), False
            ),
            "xsens": Format(
                data / "imu_opensense_walk" / "MT_012005D6_009-001_00B421E6.txt", _read(read_imu), True
            ),
            "imu.csv": Format(data / "imu_gaitmap_foot" / "imu_sample.csv", _read(read_imu), True),
        }
    return found


def _make(folder: Path) -> None:
    person, made = synthesise("walk", seconds=SECONDS)
    write_folder(person, made, folder)
    capture = read_capture(folder / "trial.c3d")
    write_capture(capture, folder / "trial.trc")
    result = reconstruct(capture, person)
    write_reconstruction(result, summarise(result), folder / "result")
    shutil.copy(data_folder("markers") / "reference36.toml", folder / "set.toml")
    (folder / "own.toml").write_text("[dynamic.motion]\nquiet_share = 0.2\nbusy_shares = [2.0, 8.0]\n")
    (folder / "list.toml").write_text('[[subject]]\nname = "P"\nmass_kg = 70.0\ntrials = ["trial.c3d"]\n')
    (folder / "list.csv").write_text(
        "subject,session,trial,static,forces,mass_kg\nP,,trial.c3d,static.c3d,,70\n"
    )
    rows = np.zeros(50, dtype=np.dtype([("frame", "<i8"), ("q", "<f8", (7,))]))
    with FrameLogWriter(folder / "frames.log", rows.dtype, {"subject": "P"}) as log:
        log.append(rows)


def _read(reader: Callable[[Path], object]) -> Callable[[Path], bool]:
    def read(path: Path) -> bool:
        reader(path)
        return True

    return read


def _capture(path: Path) -> bool:
    return _possible(read_capture(path))


def _forces(markers: Path) -> Callable[[Path], bool]:
    def read(path: Path) -> bool:
        return _possible(read_capture(markers, forces=path))

    return read


def _table(path: Path) -> bool:
    return bool((np.diff(read_storage(path).times_s) >= 0.0).all())


def _possible(capture: Capture) -> bool:
    """Whether all places and forces are possible, or something is told of them."""
    far = np.nanmax(np.abs(capture.markers.positions_m), initial=0.0) > MOST_M
    strong = any(np.nanmax(np.abs(plate.force_n), initial=0.0) > MOST_N for plate in capture.plates)
    return not (far or strong)
