"""Ground reactions and markers of one true walk, written in every dialect that is read, against the truth."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.any_capture import dialects
from benchmarks.any_capture.dialects import MM, NAMINGS, TrueCapture, TruePlate
from benchmarks.checks import Check, Context
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.axes import rotation_to_world
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.trc import write_trc
from mbkf.synthesis.capture import CaptureSettings
from mbkf.trial.synth import synthesise

SECONDS = 1.5
SEED = 3
WRENCH_BOUND = 1e-6
MARKER_BOUND_M = 1e-6
_LEAST_FORCE_N = 1.0
_EXACT = CaptureSettings(force_sd_n=0.0, moment_sd_nm=0.0, offset_n=(0.0, 0.0))


def forces_rows(context: Context) -> list[Check]:
    """Difference of wrenches and markers from the truth, per dialect; a dialect that is refused fails its rows."""
    folder = context.out / "forces"
    folder.mkdir(parents=True, exist_ok=True)
    true = true_walk()
    rows = []
    for name, read in readings(true, folder):
        rows.append(
            Check(f"wrenches, {name}, relative difference", wrench_difference(true, read), WRENCH_BOUND, "<=")
        )
        if read is not None and not name.startswith("MOT"):
            rows.append(Check(f"markers, {name}", marker_difference_m(true, read), MARKER_BOUND_M, "<=", "m"))
    return rows


def true_walk() -> TrueCapture:
    """A short walk over plates, with hidden samples and without noise of the plates."""
    _, made = synthesise("walk", seconds=SECONDS, seed=SEED, settings=_EXACT)
    plates = tuple(_true_plate(plate) for plate in made.trial.plates[: len(NAMINGS["f1_1"][1])])
    return TrueCapture(made.trial.markers, plates, made.trial.plates[0].rate_hz)


def _true_plate(plate: PlateReadings) -> TruePlate:
    """A plate's readings as force, centre of pressure on its surface and free moment; nothing below 1 N."""
    assert plate.corners_m is not None  # synthetic plates have them
    middle = plate.corners_m.mean(axis=0)
    pressed = plate.force_n[:, 2] >= _LEAST_FORCE_N
    force = np.where(pressed[:, None], plate.force_n, 0.0)
    moment = plate.moment_nm + np.cross(plate.origin_m - middle, plate.force_n)
    vertical = np.where(pressed, force[:, 2], 1.0)
    arm = np.cross([0.0, 0.0, 1.0], moment) / vertical[:, None]
    point = np.where(pressed[:, None], middle + arm, middle)
    torque = np.where(pressed, (moment - np.cross(arm, plate.force_n))[:, 2], 0.0)
    return TruePlate(plate.corners_m, force, point, torque)


def readings(true: TrueCapture, folder: Path) -> Iterator[tuple[str, Capture | None]]:
    """Each dialect's name, and the capture read from its files; None where it was refused."""
    trc = folder / "walk.trc"
    write_trc(true.markers, trc)
    for number, naming in enumerate(NAMINGS):
        path = folder / f"grf{number}.mot"
        dialects.write_mot(true, path, naming)
        yield f"MOT {naming}", _read(trc, path)
    promising = folder / "promising.mot"
    dialects.write_mot(true, promising, "ground_force_r_vx", promised_rows=5 * len(true.times_s))
    yield "MOT that promises more rows", _read(trc, promising)

    dialects.write_cortex(true, folder / "y.forces", "y")
    yield "TRC and Cortex .forces, y up", _read(trc, folder / "y.forces")
    _write_trc_z_up(true.markers, folder / "z.trc")
    dialects.write_cortex(true, folder / "z.forces", "z")
    yield "TRC and Cortex .forces, z up", _read(folder / "z.trc", folder / "z.forces", up="z")

    dialects.write_motive(true, folder / "take.csv")
    yield "Motive CSV", _read(folder / "take.csv", dialects.write_plate_tables(true, folder))
    for local, with_times in ((True, True), (True, False), (False, True), (False, False)):
        axes, times = "plate" if local else "laboratory", "with" if with_times else "without"
        path = folder / f"{axes}_{times}.tsv"
        dialects.write_qualisys(true, path, in_plate_axes=local, with_times=with_times)
        yield f"Qualisys TSV, {axes} axes, {times} times", _read(path, None)
    dialects.write_devices_table(true, folder / "devices.csv")
    yield "TRC and CSV of all plates", _read(folder / "z.trc", folder / "devices.csv", up="z")


def _read(trial: Path, forces: Path | None, up: str | None = None) -> Capture | None:
    try:
        return read_capture(trial, forces=forces, up=up)
    except MbkfError:
        return None


def _write_trc_z_up(markers: MarkerTrajectories, path: Path) -> None:
    """A TRC file in the world's own axes, made by turning the markers against the writer's turn."""
    turned = markers.positions_m @ rotation_to_world("y").T
    write_trc(MarkerTrajectories(markers.names, turned, markers.rate_hz, markers.start_time_s), path)


def wrench_difference(true: TrueCapture, read: Capture | None) -> float:
    """Largest difference of force or moment about the world's origin, over the largest of the truth.

    Args:
        true: The truth.
        read: What was read; None, or other plates or times than the truth's, give infinity.
    """
    if read is None or len(read.plates) != len(true.plates):
        return float("inf")
    worst = 0.0
    for truth, plate in zip(true.plates, read.plates, strict=True):
        if len(plate.times_s) != len(true.times_s) or abs(plate.times_s - true.times_s).max() > 1e-4:
            return float("inf")
        about_origin = plate.moment_nm + np.cross(plate.origin_m, plate.force_n)
        found = np.hstack([plate.force_n, about_origin])
        worst = max(
            worst, *(_relative(found[:, part], truth.wrench[:, part]) for part in (slice(3), slice(3, 6)))
        )
    return worst


def _relative(found: Array, truth: Array) -> float:
    return float(np.abs(found - truth).max() / max(np.abs(truth).max(), 1e-12))


def marker_difference_m(true: TrueCapture, read: Capture) -> float:
    """Largest difference of a coordinate in m; infinity where names, times or missing samples differ."""
    markers = read.markers
    same = markers.names == true.markers.names and np.array_equal(markers.present, true.markers.present)
    if not same or abs(markers.times_s - true.markers.times_s).max() > 1.0 / MM:
        return float("inf")
    return float(np.nanmax(np.abs(markers.positions_m - true.markers.positions_m)))
