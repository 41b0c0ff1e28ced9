"""Every format that mbkf reads: a sample, its reader, and what the numbers in it may not be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.robustness.samples import LAST, make_samples
from mbkf.io.capture import read_capture
from mbkf.io.frame_log import read_frame_log
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.mount import read_mounts
from mbkf.io.norms import read_norms
from mbkf.io.plausible import MASSES_KG, RATES_HZ
from mbkf.io.preset import read_preset
from mbkf.io.records import Capture
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.storage import read_storage
from mbkf.io.subject import read_subject
from mbkf.io.truth import read_truth
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.study.batch.curves import read_curves
from mbkf.study.batch.inputs import is_made_from
from mbkf.study.batch.run import plan_of
from mbkf.trial.info import describe
from mbkf.trial.protocol.from_osim import import_osim
from mbkf.viz.report.document import read_labels

MOST_M, MOST_N = 1e4, 1e6
"""Beyond these a place or a force is impossible."""

MOST_MPS2, MOST_RAD_S = 1e5, 1e5
"""Beyond these a reading of a sensor is impossible."""


@dataclass(frozen=True)
class Format:
    """A format.

    Attributes:
        file: An undamaged file.
        read: Reads a file; returns whether what it holds is possible.
        text: Whether it is text.
        beside: Undamaged files that have to lie beside it.
    """

    file: Path
    read: Callable[[Path], bool]
    text: bool
    beside: tuple[Path, ...] = ()


def formats(folder: Path, data: Path | None = None) -> dict[str, Format]:
    """All formats by name, with files made in a folder.

    Args:
        folder: Where to make them; what was made there before is taken.
        data: Folder of the reference captures, for files of the makers of inertial sensors.
    """
    if not (folder / LAST).is_file():
        make_samples(folder)
    return {**_captures(folder), **_settings(folder), **_sensors(folder), **_real(data)}


def _captures(folder: Path) -> dict[str, Format]:
    """Captures, ground reactions and results."""
    result, markers = folder / "result", folder / "trial.trc"
    plates = tuple(sorted((folder / "plates").glob("*.csv")))
    plate_files = tuple(sorted(folder.glob("qualisys_f_*.tsv")))
    return {
        "c3d": Format(folder / "trial.c3d", _capture, False),
        "c3d.info": Format(folder / "trial.c3d", _read(lambda path: describe(read_capture(path))), False),
        "trc": Format(markers, _capture, True),
        "motive": Format(folder / "motive.csv", _capture, True),
        "qualisys": Format(folder / "qualisys.tsv", _capture, True, plate_files),
        "qualisys.plate": Format(plate_files[0], _forces(markers), True, plate_files[1:]),
        "mot": Format(result / "torques.sto", _table, True),
        "forces": Format(result / "reactions.mot", _forces(markers), True),
        "cortex": Format(folder / "cortex.forces", _forces(markers), True),
        "devices.csv": Format(folder / "devices.csv", _forces(markers), True),
        "plates.csv": Format(plates[0], _forces(markers), True, plates[1:]),
        "motion": Format(result / "motion.h5", _read(read_reconstruction), False),
        "summary": Format(result / "summary.json", _read(lambda path: read_summary(path.parent)), True),
        "curves": Format(result / "curves.parquet", _read(read_curves), False),
        "truth": Format(folder / "truth.h5", _read(read_truth), False),
        "log": Format(folder / "frames.log", _read(read_frame_log), False),
    }


def _settings(folder: Path) -> dict[str, Format]:
    """Persons, marker sets, bodies, presets, lists and records."""
    return {
        "subject": Format(folder / "subject.toml", _subject, True),
        "protocol": Format(folder / "set.toml", _protocol, True),
        "body": Format(folder / "body.toml", _read(load_body), True),
        "osim": Format(folder / "model.osim", _read(import_osim), True),
        "preset": Format(folder / "own.toml", _read(read_preset), True),
        "list": Format(folder / "list.toml", _read(plan_of), True),
        "list.csv": Format(folder / "list.csv", _read(plan_of), True),
        "session": Format(folder / "study" / "P01" / "session.toml", _session, True),
        "norms": Format(folder / "norms.toml", _read(read_norms), True),
        "record": Format(folder / "batch.json", _read(lambda path: is_made_from(path, {})), True),
        "labels": Format(folder / "labels.json", _read(read_labels), True),
        "mounts": Format(folder / "mounts.toml", _read(read_mounts), True),
    }


def _sensors(folder: Path) -> dict[str, Format]:
    """Readings of inertial sensors."""
    xsens = folder / "xsens"
    export, mapping = xsens / "MT_00B421E6.txt", xsens / "mapping.xml"
    return {
        "imu.csv": Format(folder / "made.csv", _imu, True),
        "mat": Format(folder / "broad.mat", _imu, False),
        "mat.packed": Format(folder / "packed.mat", _imu, False),
        "mat.struct": Format(folder / "qmt.mat", _imu, False),
        "xsens": Format(export, _imu, True),
        "dot": Format(folder / "makers" / "D422CD00_20260101.csv", _imu, True),
        "shimmer": Format(folder / "makers" / "shimmer.csv", _imu, True),
        "delsys": Format(folder / "makers" / "delsys.csv", _imu, True),
        "mvnx": Format(folder / "makers" / "suit.mvnx", _imu, True),
        "xdf": Format(folder / "makers" / "recording.xdf", _imu, False),
        "c3d.imu": Format(folder / "makers" / "trial.c3d", _imu, False),
        "phyphox": Format(folder / "makers" / "left_foot.zip", _imu, False),
        "xsens.mapping": Format(mapping, lambda path: _imu(path.parent), True, (export,)),
    }


def _real(data: Path | None) -> dict[str, Format]:
    """Files of makers, where there are any."""
    if data is None:
        return {}
    return {
        "mat.broad": Format(
            data / "imu_broad" / "16_undisturbed_fast_translation_B.mat", _read(read_imu), False
        ),
        "xsens.real": Format(
            data / "imu_opensense_walk" / "MT_012005D6_009-001_00B421E6.txt", _read(read_imu), True
        ),
        "imu.csv.real": Format(data / "imu_gaitmap_foot" / "imu_sample.csv", _units, True),
    }


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


def _session(path: Path) -> bool:
    """A folder with one trial, whose name is all that is asked of it."""
    (path.parent / "walk.c3d").touch()
    plan_of(path.parent)
    return True


def _subject(path: Path) -> bool:
    person = read_subject(path)
    numbers = [person.height_m or 1.0, *person.scale_factors.values()]
    places = [marker.position_m for marker in person.markers]
    right = MASSES_KG[0] <= person.mass_kg <= MASSES_KG[1] and bool(np.isfinite(numbers).all())
    return right and float(np.max(np.abs(places), initial=0.0)) <= MOST_M


def _protocol(path: Path) -> bool:
    markers = load_protocol(path).markers
    numbers = [
        [*marker.position_m, marker.noise_m, marker.placement_sd_m, marker.probability] for marker in markers
    ]
    texts = all(isinstance(marker.name, str) for marker in markers)
    return texts and float(np.max(np.abs(numbers), initial=0.0)) <= MOST_M


def _imu(path: Path) -> bool:
    return all(
        RATES_HZ[0] <= one.rate_hz <= RATES_HZ[1]
        and _largest(one.specific_force_mps2) <= MOST_MPS2
        and _largest(one.angular_velocity_rad_s) <= MOST_RAD_S
        and bool(np.isfinite(one.time_s).all() and (np.diff(one.time_s) >= 0.0).all())
        for one in read_imu(path)
    )


def _units(path: Path) -> bool:
    """A table that does not state its units."""
    return bool(read_imu(path, units={"acc": "m/s^2", "gyr": "deg/s"}, rate_hz=200.0))


def _possible(capture: Capture) -> bool:
    """Whether all places and forces are possible, or something is told of them."""
    far = _largest(capture.markers.positions_m) > MOST_M
    strong = any(_largest(plate.force_n) > MOST_N for plate in capture.plates)
    return not (far or strong)


def _largest(values: np.ndarray) -> float:
    """The largest size of a number, where there is any."""
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))
